// Candidates for contacts, made eight at a time, against what one sample after another gives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "gotai/collision/exact_surface.h"
#include "gotai/collision/sample_candidates.h"
#include "gotai/collision/surface_contacts.h"
#include "gotai/collision/surface_sample.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"

namespace gotai::collision {
namespace {

voxel::Shape make_solid(const geometry::GeneratorOptions& options) {
  return voxel::make_shape(options.shape, geometry::generate(options),
                           {.prepared_level = 4, .surface_level = 5});
}

// Samples of a shape near another shape or itself.
struct NearCase {
  voxel::Shape p;
  voxel::Shape q;
  ExactSurface exact;
  voxel::SignedDistance surface;
  Random random{51};
  Pose X_QP;  // of the frames S
  SurfaceSearch search;

  explicit NearCase(const geometry::GeneratorOptions& options)
      : p(make_solid(options)), q(make_solid({.shape = "hexapod"})), exact(p), surface(p.mesh) {}

  void move(double farthest, float margin) {
    X_QP = {random.uniform(0.0, farthest) * random.unit_vector(), random.rotation()};
    search_field(p.surface.tree, q.surface.field, pose(), margin, search);
  }
  SamplePose pose() const { return make_sample_pose(X_QP.q.toRotationMatrix(), X_QP.p); }
  NearSurface near(bool samples_of_b, bool curved) const {
    NearSurface result{p.surface,
                       q.surface.field,
                       curved ? &exact.curved : nullptr,
                       pose(),
                       {1, 0, 0, 0, 1, 0, 0, 0, 1},
                       {0.1, -0.2, 0.3},
                       samples_of_b};
    if (samples_of_b) {
      const Mat3 R = X_QP.q.toRotationMatrix();
      for (int i = 0; i < 9; ++i) {
        result.rotation_AP[static_cast<std::size_t>(i)] = R(i / 3, i % 3);
      }
    }
    return result;
  }
};

const std::vector<geometry::GeneratorOptions>& solids() {
  static const std::vector<geometry::GeneratorOptions> all = {
      {.shape = "hexapod"},
      {.shape = "cube"},
      {.shape = "rock"},
      {.shape = "torus", .size = 1.0, .subdivisions = 24, .thickness = 0.5}};
  return all;
}

// Everything may close.
constexpr Closing kAll{{0.0F, 0.0F, 0.0F}, {0.0F, 0.0F, 0.0F}, 1e9F, 0.0F};

// The slope of Q's field that gives a sample its normal: just beneath it where it is sharp and
// touches.
Vec3 slope_for(const NearCase& c, const SurfaceHit& hit) {
  const double cell = static_cast<double>(c.q.surface.field.cell);
  const voxel::SurfaceTree& tree = c.p.surface.tree;
  if (!(tree.elements[hit.sample].cone_cosine < 0.9F) ||
      std::abs(static_cast<double>(hit.distance)) >= 0.02 * cell) {
    return to_double(hit.gradient);
  }
  const Vec3 x = sample_point(c.p.surface, hit.sample) - c.p.surface.center;
  return voxel::evaluate(
             c.q.surface.field,
             c.X_QP * (x - 0.1 * cell * to_double(unit_normal(tree.elements[hit.sample]))))
      .gradient;
}

TEST(Candidates, AreWhatTheirSampleAndTheFieldSayOneByOne) {
  for (const geometry::GeneratorOptions& options : solids()) {
    NearCase c(options);
    CandidateScratch scratch;
    std::vector<ContactCandidate> found;
    std::size_t count = 0;
    for (int trial = 0; trial < 60; ++trial) {
      const bool of_b = trial % 2 == 1;
      c.move(0.9, 0.1F);
      const NearSurface near = c.near(of_b, false);
      found.clear();
      append_candidates(near, c.search.hits, 0.1F, kAll, scratch, found);
      const Mat3 R = c.X_QP.q.toRotationMatrix();
      const Mat3 R_AP = of_b ? R : Mat3(Mat3::Identity());
      std::size_t k = 0;
      for (const SurfaceHit& hit : c.search.hits) {
        const Vec3 slope = R.transpose() * slope_for(c, hit);
        const Vec3 d = fit_to_normal_cone(c.p.surface.tree, hit.sample, -slope.normalized());
        const bool is_found =
            k < found.size() && found[k].feature == surface_feature(of_b ? 1 : 0, hit.sample);
        // At the rim of what is left out a rounding decides.
        if (is_found == d.isZero()) continue;
        if (!is_found) continue;
        const ContactCandidate& candidate = found[k++];
        ++count;
        const Vec3 normal = of_b ? Vec3(R_AP * d) : Vec3(-d);
        ASSERT_NEAR((candidate.normal_A - normal).norm(), 0.0, 2e-5) << options.shape;
        ASSERT_EQ(candidate.gap, static_cast<double>(hit.distance));
        const Vec3 x = R_AP * (sample_point(c.p.surface, hit.sample) - c.p.surface.center) +
                       Vec3(0.1, -0.2, 0.3);
        const Vec3 point = of_b ? Vec3(x + candidate.gap * candidate.normal_A) : x;
        ASSERT_NEAR((candidate.point_A - point).norm(), 0.0, 1e-12);
        ASSERT_NEAR(candidate.area, facing_area(c.p.surface, hit.sample, d), 1e-6);
      }
      ASSERT_EQ(k, found.size()) << options.shape;
    }
    EXPECT_GT(count, 1000U) << options.shape;
  }
}

// Samples of a smooth surface end where they face the other body: at the foot of a plane's normal.
TEST(Candidates, OfCurvedSurfacesSlideToWhereTheyFaceTheOtherBody) {
  NearCase c({.shape = "torus", .size = 1.0, .subdivisions = 24, .thickness = 0.5});
  CandidateScratch scratch;
  std::vector<ContactCandidate> straight;
  std::vector<ContactCandidate> slid;
  std::size_t moved = 0;
  for (int trial = 0; trial < 60; ++trial) {
    c.move(0.9, 0.05F);
    straight.clear();
    slid.clear();
    append_candidates(c.near(false, false), c.search.hits, 0.05F, kAll, scratch, straight);
    append_candidates(c.near(false, true), c.search.hits, 0.05F, kAll, scratch, slid);
    std::size_t k = 0;
    for (const ContactCandidate& candidate : slid) {
      while (k < straight.size() && straight[k].feature < candidate.feature) ++k;
      if (k == straight.size() || straight[k].feature != candidate.feature) continue;
      ASSERT_LE(candidate.gap, straight[k].gap);
      const Vec3 slide = candidate.point_A - straight[k].point_A;
      if (slide.isZero()) continue;
      ++moved;
      ASSERT_LE(slide.norm(), 1.2 * c.exact.curved.reach());
      // Where it says, the field has that value.
      const Vec3 x = candidate.point_A - Vec3(0.1, -0.2, 0.3);
      ASSERT_NEAR(voxel::evaluate(c.q.surface.field, c.X_QP * x).distance, candidate.gap, 1e-5);
      // And that is a point of the smooth surface: the mesh is up to 2e-3 of the tube inside it.
      const Vec3 on_mesh = x + c.p.surface.center;
      ASSERT_NEAR(c.surface.query(on_mesh).distance, 0.0, 3e-3);
    }
  }
  EXPECT_GT(moved, 1000U);
}

TEST(Candidates, LeaveOutWhatCannotClose) {
  NearCase c({.shape = "rock"});
  CandidateScratch scratch;
  std::vector<ContactCandidate> all;
  std::vector<ContactCandidate> some;
  const Vec3 v(0.3, -0.4, 0.2);
  const Vec3 w(1.0, 2.0, -0.5);
  const Closing closing{{0.3F, -0.4F, 0.2F}, {1.0F, 2.0F, -0.5F}, 0.01F, 0.05F};
  std::size_t left_out = 0;
  std::size_t kept = 0;
  for (int trial = 0; trial < 60; ++trial) {
    c.move(0.9, 0.1F);
    all.clear();
    some.clear();
    append_candidates(c.near(trial % 2 == 1, false), c.search.hits, 0.1F, kAll, scratch, all);
    append_candidates(c.near(trial % 2 == 1, false), c.search.hits, 0.1F, closing, scratch, some);
    std::size_t k = 0;
    for (const ContactCandidate& candidate : all) {
      const double approach =
          std::max(0.0, -candidate.normal_A.dot(v + w.cross(candidate.point_A)));
      const double limit = 0.01 + 0.05 * approach;
      const bool is_kept = k < some.size() && some[k].feature == candidate.feature;
      if (std::abs(candidate.gap - limit) > 1e-6) {
        ASSERT_EQ(is_kept, candidate.gap < limit);
      }
      k += is_kept ? 1 : 0;
      (is_kept ? kept : left_out) += 1;
    }
    ASSERT_EQ(k, some.size());
  }
  EXPECT_GT(kept, 500U);
  EXPECT_GT(left_out, 500U);
}

TEST(Candidates, HaveTheSameBitsOnEveryKernel) {
  for (const Kernel kernel : {Kernel::avx2, Kernel::avx512}) {
    if (!is_available(kernel)) continue;
    for (const geometry::GeneratorOptions& options : solids()) {
      NearCase c(options);
      CandidateScratch scratch;
      std::vector<ContactCandidate> portable;
      std::vector<ContactCandidate> other;
      for (int trial = 0; trial < 60; ++trial) {
        c.move(0.9, 0.1F);
        portable.clear();
        other.clear();
        const NearSurface near = c.near(trial % 2 == 1, true);
        append_candidates(near, c.search.hits, 0.1F, kAll, scratch, portable, Kernel::portable);
        append_candidates(near, c.search.hits, 0.1F, kAll, scratch, other, kernel);
        ASSERT_EQ(portable.size(), other.size());
        for (std::size_t i = 0; i < portable.size(); ++i) {
          ASSERT_EQ(portable[i].feature, other[i].feature);
          ASSERT_EQ(portable[i].gap, other[i].gap);
          ASSERT_EQ(portable[i].area, other[i].area);
          ASSERT_EQ(portable[i].point_A, other[i].point_A);
          ASSERT_EQ(portable[i].normal_A, other[i].normal_A);
          ASSERT_EQ(portable[i].near_edge, other[i].near_edge);
        }
        const auto& points = c.p.surface.tree.vertices;
        if (points.empty()) continue;
        const std::size_t count = std::min<std::size_t>(points.size(), 37);
        std::vector<FieldAtPoint> one(count);
        std::vector<FieldAtPoint> two(count);
        look_up_field(near.field, near.pose, 0.1F, std::span(points).first(count), one,
                      Kernel::portable);
        look_up_field(near.field, near.pose, 0.1F, std::span(points).first(count), two, kernel);
        for (std::size_t i = 0; i < count; ++i) {
          ASSERT_EQ(one[i].distance, two[i].distance);
          ASSERT_EQ(one[i].slope, two[i].slope);
          const double exact = voxel::evaluate(near.field, c.X_QP * to_double(points[i])).distance;
          if (exact < 0.1 - 1e-5) {
            ASSERT_NEAR(static_cast<double>(one[i].distance), exact, 2e-6);
          } else {
            ASSERT_GT(one[i].distance, 0.1F - 2e-5F);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace gotai::collision
