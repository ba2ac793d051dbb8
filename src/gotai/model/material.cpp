#include "gotai/model/material.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "gotai/core/error.h"

namespace gotai::model {

SurfacePair MaterialTable::combine(std::uint32_t a, std::uint32_t b) const {
  const auto it = overrides.find(std::minmax(a, b));
  if (it != overrides.end()) return it->second;
  const Material& material_a = materials[a];
  const Material& material_b = materials[b];
  if (a == b) return {material_a.restitution, material_a.friction};
  return {std::max(material_a.restitution, material_b.restitution),
          std::sqrt(material_a.friction * material_b.friction)};
}

void validate(const MaterialTable& table) {
  const auto check = [](const std::string& name, double e, double mu) {
    if (!(e >= 0.0 && e <= 1.0))
      throw InvalidArgument(name + ".restitution", std::to_string(e), "must be in [0, 1]");
    if (!(mu >= 0.0) || !std::isfinite(mu))
      throw InvalidArgument(name + ".friction", std::to_string(mu), "must be >= 0 and finite");
  };
  for (const Material& material : table.materials) {
    const std::string name = "material '" + material.name + "'";
    check(name, material.restitution, material.friction);
    if (!(material.density > 0.0) || !std::isfinite(material.density))
      throw InvalidArgument(name + ".density", std::to_string(material.density),
                            "must be positive and finite [kg/m^3]");
  }
  for (const auto& [key, pair] : table.overrides) {
    if (key.first > key.second || key.second >= table.materials.size())
      throw InvalidArgument("material_pair", std::to_string(key.second), "no such material");
    check("material_pair '" + table.materials[key.first].name + "', '" +
              table.materials[key.second].name + "'",
          pair.restitution, pair.friction);
  }
}

}  // namespace gotai::model
