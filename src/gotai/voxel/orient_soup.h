/// @file
/// Turning the triangles of an imperfect surface the right way out.
#pragma once

#include <cstddef>

#include "gotai/geometry/mesh.h"

namespace gotai::voxel {

/// A surface whose triangles agree on inside and outside as far as that can be known.
struct OrientedSoup {
  geometry::Mesh mesh;         ///< welded, without tetrahedra, degenerate and duplicate triangles
  std::size_t patches = 0;     ///< pieces joined by edges of two triangles
  std::size_t reversed = 0;    ///< triangles that were turned round
  std::size_t duplicates = 0;  ///< triangles dropped because others have the same vertices
};

/// Re-orients a surface with holes, flipped triangles, flipped patches and doubled faces.
///
/// Triangles joined by an edge that no third triangle has are made to agree; what they then form is
/// a patch. A patch is turned so that its front sees the outside: rays from both of its sides tell
/// which one reaches infinity [after Takayama et al. 2014, "A simple method for correcting facet
/// orientations in polygon meshes based on ray casting"]. A patch that neither side of which does
/// (a cavity's wall, a part inside a part) keeps the direction that most of its area had, and is
/// decided by the parity of the hits when it had none. Deterministic.
OrientedSoup orient_soup(const geometry::Mesh& mesh);

}  // namespace gotai::voxel
