#include "gotai/collision/sphere_tree.h"

#include <fmt/format.h>

#include "gotai/core/error.h"

namespace gotai::collision {

SphereTree make_sphere_tree(const voxel::Pyramid& pyramid) {
  SphereTree tree;
  tree.pyramid = &pyramid;
  for (int h = 1; h <= pyramid.max_level(); ++h) tree.centers.push_back(pyramid.voxel_centers(h));
  for (int h = 1; h < pyramid.max_level(); ++h) {
    const voxel::PyramidLevel& parents = pyramid.level(h);
    const voxel::PyramidLevel& children = pyramid.level(h + 1);
    std::vector<SphereTree::Node>& nodes = tree.levels.emplace_back(parents.size());
    for (std::size_t i = 0; i < parents.size(); ++i) {
      nodes[i].first_child = parents.first_child[i];
      for (std::uint32_t c = parents.first_child[i]; c < parents.first_child[i + 1]; ++c) {
        const auto& index = children.index[c];
        const std::uint32_t octant =
            (index[0] & 1U) | ((index[1] & 1U) << 1U) | ((index[2] & 1U) << 2U);
        // Ranks among siblings are counted in the octants' bits.
        if (nodes[i].octants >> octant != 0) {
          throw InvalidArgument("pyramid", fmt::format("level {}, voxel {}", h + 1, c),
                                "the children of a voxel must be in Morton order, x fastest");
        }
        nodes[i].octants |= 1U << octant;
      }
    }
  }
  return tree;
}

}  // namespace gotai::collision
