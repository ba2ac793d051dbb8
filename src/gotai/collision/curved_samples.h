/// @file
/// The smooth surface that a finely cut mesh stands for, around each sample of it: bodies roll on
/// that, not from facet to facet.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "gotai/core/bytes_of.h"
#include "gotai/core/types.h"
#include "gotai/voxel/shape.h"
#include "gotai/voxel/signed_distance.h"

namespace gotai::collision {

/// The surface near a smooth sample, to second order. Frame S of the surface model.
struct CurvedSample {
  Vec3 point;                     ///< the sample, lifted from its facet [m]
  Vec3 normal;                    ///< unit, outward
  std::array<Vec3, 2> direction;  ///< of principal curvature, unit
  Eigen::Vector2d curvature;      ///< along them, > 0 where convex [1/m]; 0 where nearly flat
};

/// Where the surface faces along a direction: how far to slide from the sample, along its
/// principal directions [m]; 0 where the surface is not convex.
/// @param toward  unit; frame S
Eigen::Vector2d slide_to_face(const CurvedSample& sample, const Vec3& toward);

/// The point of the surface after a slide [m]; frame S. Exact on spheres.
Vec3 slid_point(const CurvedSample& sample, const Eigen::Vector2d& slide);

/// Smooth samples of a shape. A sample is smooth where the mesh around it bends at every edge, by
/// little: vertex normals [Max 1999, "Weights for computing vertex normals from facet normals"]
/// and curvatures [Rusinkiewicz 2004, "Estimating curvatures and their derivatives on triangle
/// meshes"] then tell the surface between its vertices.
class CurvedSamples {
 public:
  CurvedSamples() = default;
  /// @param surface  of the mesh that the samples are of
  CurvedSamples(const voxel::SurfaceModel& model, const voxel::SignedDistance& surface);

  /// Null where the surface is flat, or has edges.
  const CurvedSample* find(std::uint32_t sample) const {
    return index_.empty() || index_[sample] < 0
               ? nullptr
               : &samples_[static_cast<std::size_t>(index_[sample])];
  }
  /// Farthest slide for which a sample speaks: beyond it others do [m].
  double reach() const { return reach_; }
  std::size_t bytes() const { return bytes_of(index_) + bytes_of(samples_); }  ///< on the heap

 private:
  std::vector<std::int32_t> index_;  // per sample; -1: not smooth
  std::vector<CurvedSample> samples_;
  double reach_ = 0.0;
};

}  // namespace gotai::collision
