/// @file
/// Points on a surface that stand for it in collisions: evenly spread on faces, and always at sharp
/// convex corners and along sharp convex edges, which touch first.
#pragma once

#include <cstdint>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/voxel/signed_distance.h"

namespace gotai::voxel {

enum class SampleKind : std::uint8_t { face, edge, corner };

/// A point of the surface and the part of the surface that it stands for. Mesh frame M.
struct SurfaceSample {
  Vec3 position = Vec3::Zero();  ///< on the surface [m]
  /// Axis of the cone of the outward normals around the point, unit.
  Vec3 normal = Vec3::Zero();
  double cone_cosine = 1.0;  ///< cosine of the cone's half angle: 1 on a flat face
  double area = 0.0;         ///< of the surface nearest to this sample [m^2]; all sum to the total
  /// The same as a vector, the integral of the outward normal [m^2]: its component along a
  /// direction is the area seen from there. Samples of edges stand for strips of two faces, of
  /// which a body that lies on one face meets only one.
  Vec3 vector_area = Vec3::Zero();
  SampleKind kind = SampleKind::face;
  Vec3 edge_direction = Vec3::Zero();  ///< unit, of edge samples; zero for others
  /// How far the sample may slide against and along edge_direction before it leaves the straight
  /// edge or its share of it [m].
  double reach_back = 0.0;
  double reach_forward = 0.0;
  /// Convex vertices of the mesh that are nearest to this sample, itself excepted [m]: where a fine
  /// mesh touches between its samples.
  std::vector<Vec3> vertices;
};

/// Convex edges whose faces' normals differ by more than this are sharp [rad].
inline constexpr double kSharpAngle = 0.3;  // 17 degrees

/// Samples of a sharp edge are no farther apart than this many spacings.
inline constexpr double kEdgeSpacing = 1.2;

/// Samples a closed surface with about one point per spacing^2. Every point of the surface has a
/// sample of compatible normal within about one spacing, so both sides of a thin plate are kept.
/// The same mesh and spacing give the same samples, in the same order, on every platform.
/// @param spacing  distance between neighbouring samples [m], > 0
std::vector<SurfaceSample> sample_surface(const SignedDistance& surface, double spacing);

}  // namespace gotai::voxel
