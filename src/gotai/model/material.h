/// @file
/// Surface materials and how two of them combine.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "gotai/core/types.h"

namespace gotai::model {

/// A material. Defaults are those of a scene file without a [material] table.
struct Material {
  std::string name = "default";
  double restitution = 0.3;  ///< e in [0, 1]
  double friction = 0.5;     ///< mu >= 0
  double density = 1000.0;   ///< [kg/m^3]
};

/// What acts between two materials.
struct SurfacePair {
  double restitution = 0.0;
  double friction = 0.0;
};

/// All materials of a world. Index 0 is the default material.
struct MaterialTable {
  std::vector<Material> materials{Material{}};
  /// Overrides of the combination rule, keyed by (smaller index, larger index).
  std::map<std::pair<std::uint32_t, std::uint32_t>, SurfacePair> overrides;

  /// Restitution is the larger of the two, friction their geometric mean, unless overridden.
  SurfacePair combine(std::uint32_t a, std::uint32_t b) const;
};

/// @throws InvalidArgument naming the material and the value
void validate(const MaterialTable& table);

}  // namespace gotai::model
