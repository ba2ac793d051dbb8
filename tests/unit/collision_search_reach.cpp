// Searches that look at fewer samples where surfaces are far apart, and those that list what may
// matter soon.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "gotai/collision/surface_search.h"
#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/voxel/shape.h"

namespace gotai::collision {
namespace {

using ShapePointer = std::shared_ptr<const voxel::Shape>;

ShapePointer make_surface(const std::string& name) {
  geometry::GeneratorOptions options;
  options.shape = name;
  voxel::ShapeOptions how;
  how.prepared_level = 4;
  how.surface_level = 5;
  return std::make_shared<const voxel::Shape>(
      voxel::make_shape(name, geometry::generate(options), how));
}

bool same_bits(const std::vector<SurfaceHit>& a, const std::vector<SurfaceHit>& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), a.size() * sizeof(SurfaceHit)) == 0;
}

std::map<std::uint32_t, float> nearest_by_packet(const std::vector<SurfaceHit>& hits) {
  std::map<std::uint32_t, float> nearest;
  for (const SurfaceHit& h : hits) {
    const auto [at, is_new] = nearest.try_emplace(h.sample / voxel::kLanes, h.distance);
    if (!is_new) at->second = std::min(at->second, h.distance);
  }
  return nearest;
}

class SearchReaches : public testing::TestWithParam<std::string> {
 protected:
  ShapePointer a = make_surface(GetParam());
  ShapePointer b = make_surface("hexapod");
  const voxel::SurfaceTree& tree = a->surface.tree;
  const voxel::DistanceField& field = b->surface.field;
  Random random{51};

  SamplePose pose() {
    return make_sample_pose(random.rotation().toRotationMatrix(),
                            random.uniform(0.2, 1.3) * random.unit_vector());
  }
};

// What is near is not missed, and of what is far each packet has about its nearest.
TEST_P(SearchReaches, FarPacketsHaveAboutTheirNearestSample) {
  SurfaceSearch full;
  SurfaceSearch thin;
  const float far = field.cell;
  std::size_t near_hits = 0;
  double worst = 0.0;
  int good = 0;
  int poor = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const SamplePose X = pose();
    const auto margin = static_cast<float>(random.uniform(1.0, 15.0)) * field.cell;
    search_field(tree, field, X, margin, full);
    search_field(tree, field, X, {margin, far, far}, thin);
    EXPECT_TRUE(std::ranges::is_sorted(thin.hits, {}, &SurfaceHit::sample));
    auto in_full = full.hits.begin();
    for (const SurfaceHit& h : thin.hits) {
      while (in_full->sample != h.sample) ASSERT_NE(++in_full, full.hits.end());
      ASSERT_EQ(in_full->distance, h.distance);
      ASSERT_EQ(in_full->gradient, h.gradient);
    }
    const auto thinned = nearest_by_packet(thin.hits);
    for (const auto& [packet, distance] : nearest_by_packet(full.hits)) {
      const auto found = thinned.find(packet);
      const float instead = found == thinned.end() ? margin : found->second;
      const float about = std::max(distance, field.cell);
      const auto missed = static_cast<double>((instead - distance) / about);
      worst = std::max(worst, missed);
      (missed > 0.2 ? poor : good) += 1;
      if (distance <= 0.25F * far) {
        ASSERT_EQ(instead, distance);
      }
    }
    const auto is_near = [far](const SurfaceHit& h) { return h.distance <= far; };
    near_hits += static_cast<std::size_t>(std::ranges::count_if(thin.hits, is_near));
  }
  EXPECT_GT(near_hits, 500U);
  EXPECT_LT(worst, 1.0);
  EXPECT_LT(100 * poor, good);
  EXPECT_LT(4 * thin.tests, 3 * full.tests);
}

TEST_P(SearchReaches, ListsHoldEveryPacketThatIsNear) {
  SurfaceSearch plain;
  SurfaceSearch wide;
  SurfaceSearch listing;
  std::vector<std::uint32_t> list;
  std::size_t listed = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const SamplePose X = pose();
    const auto margin = static_cast<float>(random.uniform(0.0, 1.0)) * field.cell;
    const float up_to = margin + static_cast<float>(random.uniform(0.0, 1.0)) * field.cell;
    search_field(tree, field, X, {margin, 0.5F * margin}, plain);
    search_field(tree, field, X, up_to, wide);
    search_and_list(tree, field, X, {margin, 0.5F * margin}, up_to, listing, list);
    ASSERT_TRUE(same_bits(plain.hits, listing.hits));
    std::vector<std::uint32_t> expected;
    for (const auto& [packet, distance] : nearest_by_packet(wide.hits)) expected.push_back(packet);
    ASSERT_EQ(list, expected);
    search_packets(tree, field, X, {margin, 0.5F * margin}, list, listing);
    ASSERT_TRUE(same_bits(plain.hits, listing.hits));
    listed += list.size();
  }
  EXPECT_GT(listed, 100U);
}

// Bits, not values: what a run computes must not depend on the processor.
TEST_P(SearchReaches, HaveTheSameBitsOnEveryKernel) {
  SurfaceSearch portable;
  SurfaceSearch other;
  std::vector<std::uint32_t> list;
  std::vector<std::uint32_t> other_list;
  for (const Kernel kernel : {Kernel::avx2, Kernel::avx512}) {
    if (!is_available(kernel)) continue;
    std::size_t found = 0;
    for (int trial = 0; trial < 100; ++trial) {
      const SamplePose X = pose();
      const auto margin = static_cast<float>(random.uniform(0.0, 10.0)) * field.cell;
      const SearchReach thin{margin, field.cell, field.cell};
      search_field(tree, field, X, thin, portable, Kernel::portable);
      search_field(tree, field, X, thin, other, kernel);
      ASSERT_TRUE(same_bits(portable.hits, other.hits));
      found += portable.hits.size();
      search_field_widely(tree, field, X, thin, 1.5F * margin, other, kernel);
      ASSERT_TRUE(same_bits(portable.hits, other.hits));
      search_and_list(tree, field, X, margin, 1.2F * margin, portable, list, Kernel::portable);
      search_and_list(tree, field, X, margin, 1.2F * margin, other, other_list, kernel);
      ASSERT_TRUE(same_bits(portable.hits, other.hits));
      ASSERT_EQ(list, other_list);
    }
    EXPECT_GT(found, 500U);
  }
}
INSTANTIATE_TEST_SUITE_P(Shapes, SearchReaches, testing::Values("hexapod", "rock", "torus"));

}  // namespace
}  // namespace gotai::collision
