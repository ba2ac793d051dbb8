#include "gotai/world/true_overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "gotai/core/parallel.h"
#include "gotai/voxel/inside.h"
#include "gotai/voxel/signed_distance.h"
#include "gotai/voxel/winding_tree.h"

namespace gotai {
namespace {

using model::BodyIndex;

// Fractions of the diagonal: between points along an edge, of the gap that counts as touching, and
// of the farthest neighbour looked at.
constexpr double kPointSpacing = 0.01;
constexpr double kTouching = 1e-3;
constexpr double kFarthest = 0.05;
constexpr double kDeepest = 0.3;  // no point of a ball is deeper inside it
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A mesh with its edges and distances.
class Surface {
 public:
  explicit Surface(const voxel::Shape& shape)
      : box_(geometry::bounding_box(shape.mesh)), diagonal_(box_.diagonal().norm()) {
    if (!shape.warnings.empty() || !voxel::has_closed_surface(shape.mesh)) {
      winding_.emplace(shape.mesh);
    }
    distance_.emplace(shape.mesh, winding_ ? &*winding_ : nullptr);
    for (std::uint32_t v = 0; v < distance_->vertex_count(); ++v) {
      vertices_.push_back(distance_->vertex(v));
    }
    for (std::uint32_t t = 0; t < distance_->triangle_count(); ++t) {
      if (distance_->face_normal(t).isZero()) continue;
      const auto& corners = distance_->corners(t);
      for (int e = 0; e < 3; ++e) {
        if (distance_->neighbor(t, e) < t) continue;  // the neighbour has this edge
        edges_.push_back(
            {corners[static_cast<std::size_t>(e)], corners[static_cast<std::size_t>((e + 1) % 3)]});
      }
    }
  }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  double diagonal() const { return diagonal_; }
  const std::vector<Vec3>& vertices() const { return vertices_; }

  /// Least signed gap of this mesh's vertices and edges in another one [m]; infinite beyond the
  /// limit.
  /// @param X  this mesh's frame in the other's
  double least_gap_in(const Surface& other, const Pose& X, double limit) const {
    const double spacing = kPointSpacing * diagonal_;
    double least = limit;
    const auto measure = [&](const Vec3& x) {
      const double gap = other.gap(x, std::max(least, 0.0) + spacing);
      least = std::min(least, gap);
      return gap;
    };
    std::vector<double> at_vertex(vertices_.size());
    for (std::size_t v = 0; v < vertices_.size(); ++v) at_vertex[v] = measure(X * vertices_[v]);
    for (const auto& [from, to] : edges_) {
      const Vec3 a = X * vertices_[from];
      const Vec3 b = X * vertices_[to];
      const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / spacing)));
      double nearest = std::min(at_vertex[from], at_vertex[to]);
      int part = at_vertex[from] < at_vertex[to] ? 0 : parts;
      for (int k = 1; k < parts; ++k) {
        const double gap = measure(a + (b - a) * k / parts);
        if (gap >= nearest) continue;
        nearest = gap;
        part = k;
      }
      // Gaps change by no more than the way along the edge.
      if (nearest - spacing >= least) continue;
      descend(measure, a + (b - a) * std::max(part - 1, 0) / parts,
              a + (b - a) * std::min(part + 1, parts) / parts);
    }
    return least < limit ? least : kInfinity;
  }

 private:
  /// Signed gap of a point in this mesh; infinite if certainly above `near` (>= 0).
  double gap(const Vec3& x, double near) const {
    const double outside = box_.squaredExteriorDistance(x);
    if (outside > near * near) return kInfinity;
    const double deep = outside > 0.0 ? 0.0 : kDeepest * diagonal_;
    return distance_->query(x, std::max(near, deep)).distance;
  }

  // Golden section between two points of an edge; `measure` keeps the least.
  template <typename Measure>
  static void descend(const Measure& measure, Vec3 a, Vec3 b) {
    constexpr int kSteps = 10;
    const double share = 0.5 * (std::sqrt(5.0) - 1.0);
    Vec3 c = b - share * (b - a);
    Vec3 d = a + share * (b - a);
    double at_c = measure(c);
    double at_d = measure(d);
    for (int k = 0; k < kSteps; ++k) {
      if (at_c < at_d) {
        b = d;
        d = c;
        at_d = at_c;
        c = b - share * (b - a);
        at_c = measure(c);
      } else {
        a = c;
        c = d;
        at_c = at_d;
        d = a + share * (b - a);
        at_d = measure(d);
      }
    }
  }

  Box3 box_;
  double diagonal_;
  std::optional<voxel::WindingTree> winding_;
  std::optional<voxel::SignedDistance> distance_;
  std::vector<Vec3> vertices_;
  std::vector<std::array<std::uint32_t, 2>> edges_;
};

struct Gap {
  BodyIndex a, b;
  double gap;    // [m]
  double scale;  // diagonal of the smaller body [m]
};

/// Gaps of a body's vertices to the faces of a plane or container [m].
void add_face_gaps(const model::BodyState& bodies, BodyIndex i, BodyIndex solid,
                   const Surface& surface, double limit, std::vector<Gap>& out) {
  const bool walls = bodies.geometry[solid] == model::Geometry::container;
  const Pose X_UM = Pose{bodies.x_W[solid], bodies.q_WB[solid]}.inverse() * bodies.mesh_pose(i);
  const Vec3& half = bodies.half_extent[solid];
  std::array<double, 5> least;
  least.fill(kInfinity);
  for (const Vec3& x : surface.vertices()) {
    const Vec3 p = X_UM * x;
    least[0] = std::min(least[0], p.z());
    if (!walls || p.z() > half.z()) continue;
    least[1] = std::min(least[1], half.x() - p.x());
    least[2] = std::min(least[2], half.x() + p.x());
    least[3] = std::min(least[3], half.y() - p.y());
    least[4] = std::min(least[4], half.y() + p.y());
  }
  for (const double gap : least) {
    if (gap < limit) out.push_back({i, solid, gap, surface.diagonal()});
  }
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double median_third_gap(const model::BodyState& bodies, const std::vector<Gap>& gaps) {
  std::vector<std::vector<double>> of_body(bodies.size());
  for (const Gap& g : gaps) {
    of_body[g.a].push_back(g.gap / g.scale);
    of_body[g.b].push_back(g.gap / g.scale);
  }
  std::vector<double> third;
  for (BodyIndex i = 0; i < bodies.size(); ++i) {
    if (!bodies.is_dynamic(i) || of_body[i].size() < 3) continue;
    std::sort(of_body[i].begin(), of_body[i].end());
    third.push_back(of_body[i][2]);
  }
  return median(third);
}

}  // namespace

TrueOverlap measure_true_overlap(const model::BodyState& bodies,
                                 std::span<const std::shared_ptr<const voxel::Shape>> shapes) {
  std::vector<std::unique_ptr<const Surface>> surfaces(shapes.size());
  parallel_for(shapes.size(), 1,
               [&](std::size_t s) { surfaces[s] = std::make_unique<const Surface>(*shapes[s]); });

  std::vector<std::vector<Gap>> found(bodies.size());
  parallel_for(bodies.size(), 1, [&](std::size_t k) {
    const auto i = static_cast<BodyIndex>(k);
    if (bodies.geometry[i] != model::Geometry::shape) return;
    const Surface& own = *surfaces[bodies.shape[i]];
    const Pose X_WI = bodies.mesh_pose(i);
    for (BodyIndex j = 0; j < bodies.size(); ++j) {
      const bool is_shape = bodies.geometry[j] == model::Geometry::shape;
      if (j == i || (is_shape && j > i) || !(bodies.is_dynamic(i) || bodies.is_dynamic(j)))
        continue;
      if (!is_shape) {
        add_face_gaps(bodies, i, j, own, kFarthest * own.diagonal(), found[k]);
        continue;
      }
      const Surface& other = *surfaces[bodies.shape[j]];
      const double scale = std::min(own.diagonal(), other.diagonal());
      const double limit = kFarthest * scale;
      const double reach = bodies.bounding_radius[i] + bodies.bounding_radius[j] + limit;
      if ((bodies.x_W[i] - bodies.x_W[j]).norm() > reach) continue;
      const Pose X_JI = bodies.mesh_pose(j).inverse() * X_WI;
      const double gap = std::min(own.least_gap_in(other, X_JI, limit),
                                  other.least_gap_in(own, X_JI.inverse(), limit));
      if (gap < limit) found[k].push_back({i, j, gap, scale});
    }
  });

  std::vector<Gap> gaps;
  for (const auto& part : found) gaps.insert(gaps.end(), part.begin(), part.end());
  TrueOverlap verdict;
  std::vector<double> overlap;
  double sum = 0.0;
  for (const Gap& g : gaps) {
    if (g.gap >= kTouching * g.scale) continue;
    overlap.push_back(std::max(0.0, -g.gap) / g.scale);
    sum += overlap.back();
    verdict.max_m = std::max(verdict.max_m, -g.gap);
  }
  verdict.touching = overlap.size();
  verdict.gap3 = median_third_gap(bodies, gaps);
  if (overlap.empty()) return verdict;
  std::sort(overlap.begin(), overlap.end());
  verdict.mean = sum / static_cast<double>(overlap.size());
  verdict.p99 = overlap[(overlap.size() * 99 + 99) / 100 - 1];
  verdict.max = overlap.back();
  return verdict;
}

}  // namespace gotai
