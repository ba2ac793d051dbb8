/// @file
/// Which samples of one surface are near another: descent of an 8-ary sample tree in a distance
/// field or above a plane, eight lanes at a time. All instruction sets give the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/voxel/surface_model.h"

namespace gotai::collision {

/// Rigid transform in single precision from the frame S of the samples to the frame S of the field
/// (or of a plane): x_field = rotation x + translation.
struct SamplePose {
  std::array<float, 9> rotation;     ///< row by row
  std::array<float, 3> translation;  ///< [m]
};
/// The same, rounded from double precision.
SamplePose make_sample_pose(const Mat3& R, const Vec3& t);

/// A sample and what the field says there.
struct SurfaceHit {
  std::uint32_t sample = 0;         ///< index in the tree
  float distance = 0.0F;            ///< [m], < 0 inside
  std::array<float, 3> gradient{};  ///< of the field, in its frame; about unit length
};

/// Field values and their slopes at eight samples [cells of the field].
struct alignas(32) SampledPacket {
  std::array<float, voxel::kLanes> value;
  std::array<std::array<float, voxel::kLanes>, 3> slope;
};

/// How far a search looks.
struct SearchReach {
  /// Samples with at most this field value are hits [m].
  float margin;
  /// Of eight samples of a packet that are all farther than this only the nearest is a hit [m].
  float sparse;
  /// Of eight samples of a packet that are farther than this by the field at its centre only one is
  /// looked up: the one that is nearest if the field rises straight [m].
  float far;
  /// Samples of edges with at most this field value are hits, however few of their packets are: the
  /// edges may cross others beside them [m].
  float beside;

  // NOLINTNEXTLINE(google-explicit-constructor): most searches have a margin and nothing else.
  SearchReach(float margin_m, float sparse_m = std::numeric_limits<float>::infinity(),
              float far_m = std::numeric_limits<float>::infinity(), float beside_m = 0.0F)
      : margin(margin_m), sparse(sparse_m), far(far_m), beside(beside_m) {}
};

/// A packet of points far from the other surface, and the direction in which the field rises there,
/// in the samples' frame.
struct FarPacket {
  std::uint32_t packet = 0;
  std::array<float, 3> away{};
};

/// Storage of a search, and the work it did.
struct SurfaceSearch {
  std::vector<SurfaceHit> hits;  ///< result, by ascending sample
  float clearance = 0.0F;        ///< result of search_field_widely() [m]
  std::uint64_t tests = 0;       ///< spheres and samples looked up, summed over searches
  // Room for the packets of the height being searched, of the next, and for looked-up samples.
  std::vector<std::uint32_t> packet;
  std::vector<std::uint32_t> next;
  std::vector<SampledPacket> sampled;
  // Far packets, the first far_count, and the hits among their samples.
  std::vector<FarPacket> far;
  std::size_t far_count = 0;
  std::vector<SurfaceHit> far_hits;
};

/// Instruction set of the kernels.
enum class Kernel : std::uint8_t { automatic, portable, avx2, avx512 };
/// Whether this processor and build can run a kernel.
bool is_available(Kernel kernel);

/// Finds exactly the samples whose interpolated field value is at most the margin: the same as
/// looking at all of them. Proof in surface_search.cpp. Far packets (SearchReach) have one at most.
void search_field(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                  const SamplePose& pose, SearchReach reach, SurfaceSearch& search,
                  Kernel kernel = Kernel::automatic);

/// The same, for samples that are probably all farther away: spheres are descended into up to
/// `wide`. When none is left then, search.clearance says how far away the samples are: while none
/// moves farther than d, none has a value below clearance - d, as long as that is at most `wide`.
/// When some are left it is negative. Proof in surface_search.cpp.
/// @param wide  >= reach.margin [m]
void search_field_widely(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                         const SamplePose& pose, SearchReach reach, float wide,
                         SurfaceSearch& search, Kernel kernel = Kernel::automatic);

/// The same, and the packets of points that hold every sample up to `wide`. Nothing is far:
/// reach.far must not be less than reach.margin.
/// @param wide  >= reach.margin [m]
/// @param[out] list  ascending
void search_and_list(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                     const SamplePose& pose, SearchReach reach, float wide, SurfaceSearch& search,
                     std::vector<std::uint32_t>& list, Kernel kernel = Kernel::automatic);

/// The same among the samples of some packets of points.
/// @param packets  ascending
void search_packets(const voxel::SurfaceTree& samples, const voxel::DistanceField& field,
                    const SamplePose& pose, SearchReach reach,
                    const std::vector<std::uint32_t>& packets, SurfaceSearch& search,
                    Kernel kernel = Kernel::automatic);

/// Finds the samples whose height above a plane, normal . x + offset, is at most `margin`.
/// @param normal  unit, in the samples' frame S; also the gradient of the hits
/// @param offset  [m]
void search_half_space(const voxel::SurfaceTree& samples, const std::array<float, 3>& normal,
                       float offset, float margin, SurfaceSearch& search,
                       Kernel kernel = Kernel::automatic);

}  // namespace gotai::collision
