#include "gotai/geometry/mesh.h"

namespace gotai::geometry {

Box3 bounding_box(const Mesh& mesh) {
  Box3 box;
  for (const Triangle& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) box.extend(mesh.vertices[v]);
  for (const Tetrahedron& tet : mesh.tetrahedra)
    for (const std::uint32_t v : tet) box.extend(mesh.vertices[v]);
  return box;
}

}  // namespace gotai::geometry
