/// @file
/// What is known about a mesh: its topology, its defects, and what was repaired.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "gotai/geometry/mesh.h"

namespace gotai::geometry {

/// Findings about a mesh. An edge is a pair of vertices; its faces are the triangles that have it.
struct MeshReport {
  /// @name As the file has it (polygons counted as triangles); 0 for meshes not from files.
  ///@{
  std::string format;
  std::size_t file_vertices = 0;
  std::size_t file_triangles = 0;
  std::size_t file_tetrahedra = 0;
  ///@}

  /// @name The mesh handed out.
  ///@{
  std::size_t vertices = 0;
  std::size_t triangles = 0;
  std::size_t tetrahedra = 0;
  std::size_t components = 0;   ///< pieces that share no vertex
  Vec3 extents = Vec3::Zero();  ///< of the bounding box [m]
  double volume = 0.0;  ///< signed, of the tetrahedra or by the divergence theorem [m^3]; means the
                        ///< enclosed volume only when is_solid()
  ///@}

  /// @name Topology of the surface handed out.
  ///@{
  bool closed = false;    ///< every edge has exactly two faces
  bool oriented = false;  ///< no edge is run twice in the same direction
  bool balanced = false;  ///< every edge is run equally often in both directions: the winding
                          ///< number is an integer everywhere, even if edges have four faces
  std::size_t boundary_edges = 0;      ///< edges with one face: holes
  std::size_t non_manifold_edges = 0;  ///< edges with three or more faces
  std::size_t misoriented_edges = 0;   ///< edges with two faces that run it in the same direction
  /// Pairs of triangles that meet beyond what they share; see find_self_intersections().
  std::size_t self_intersections = 0;
  bool self_intersections_complete = true;  ///< false: there may be more than that
  ///@}

  /// @name Defects. Counted in the file's mesh after welding, before any repair.
  ///@{
  std::size_t degenerate_triangles = 0;   ///< a vertex twice, or no area
  std::size_t duplicate_triangles = 0;    ///< with the vertices of an earlier one
  std::size_t degenerate_tetrahedra = 0;  ///< a vertex twice, or no volume
  std::size_t duplicate_tetrahedra = 0;   ///< with the vertices of an earlier one
  std::size_t inverted_tetrahedra = 0;    ///< negative volume while most are positive
  ///@}

  std::vector<std::string> repairs;   ///< what was changed, one sentence each
  std::vector<std::string> warnings;  ///< what was found and left as it is, one sentence each

  /// True when the inside is well defined: a balanced surface (or tetrahedra) with positive volume.
  bool is_solid() const { return balanced && triangles > 0 && volume > 0.0; }
};

/// Fills in everything about the mesh handed out (not the file's counts, not the defects that
/// repair() counts, no sentences).
/// Expects finite vertices and indices in range; see validate().
MeshReport inspect(const Mesh& mesh);

/// Checks what all code relies on: indices in range, finite coordinates of used vertices.
/// @throws InvalidArgument naming the element and its value
void validate(const Mesh& mesh);

/// Merges vertices at exactly equal positions (0.0 and -0.0 are equal) and drops unused ones; the
/// order of first use is kept.
/// @returns how many used vertices were merged into others
std::size_t weld(Mesh& mesh);

/// Repairs what has exactly one remedy and says so in report.repairs: degenerate and duplicate
/// elements are dropped, tetrahedra re-oriented, closed components made consistent and turned
/// outward (a component inside another keeps its sign: it may be a cavity). Counts the defects it
/// finds. Expects a welded mesh.
void repair(Mesh& mesh, MeshReport& report);

}  // namespace gotai::geometry
