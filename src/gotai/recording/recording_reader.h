/// @file
/// Reads recordings back: for `gotai info`, exports, viewers and tests.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "gotai/core/types.h"
#include "gotai/geometry/mesh.h"
#include "gotai/model/body_state.h"
#include "gotai/model/material.h"
#include "gotai/voxel/pyramid.h"

namespace gotai::recording {

/// A body as it was when it entered the recording. Its number in lists below is its column.
struct RecordedBody {
  std::string name;
  model::BodyKind kind = model::BodyKind::fixed;
  model::Geometry geometry = model::Geometry::shape;
  std::uint32_t shape = 0;     ///< index of the recording's shapes; for Geometry::shape only
  std::uint32_t material = 0;  ///< index of the recording's materials
  double mass = 0.0;           ///< [kg]; 0 for bodies that impulses do not move
  Vec3 center_of_mass = Vec3::Zero();  ///< [m], mesh frame
  Vec3 half_extent = Vec3::Zero();     ///< containers: inner half edges x, y and height [m]
  double bounding_radius = 0.0;        ///< about the centre of mass [m]
};

/// A shape for drawing.
struct RecordedShape {
  std::string name;
  std::string content;                 ///< hash, hexadecimal
  geometry::Mesh mesh;                 ///< polygons; no tetrahedra
  double volume = 0.0;                 ///< [m^3]
  Vec3 center_of_mass = Vec3::Zero();  ///< [m], mesh frame
  voxel::VoxelGrid grid;
  /// Surface voxels (ix, iy, iz) per level; voxels[h - 1] is level h.
  std::vector<std::vector<std::array<std::uint16_t, 3>>> voxels;
};

/// One recorded moment. Lists have one entry per body; removed bodies have NaN.
struct Frame {
  double time = 0.0;  ///< [s]
  std::uint64_t step = 0;
  std::string state_hash;
  std::vector<Pose> poses;  ///< of the mesh frames, W
  std::vector<Vec3> v_W;    ///< velocity of the centre of mass [m/s]
  std::vector<Vec3> w_W;    ///< angular velocity [rad/s]
};

/// One contact of a frame.
struct RecordedContact {
  std::uint32_t body_a = 0;
  std::uint32_t body_b = 0;
  Vec3 point_W;    ///< [m]
  Vec3 normal_W;   ///< unit, from b to a
  double gap;      ///< [m], < 0 overlap
  Vec3 impulse_W;  ///< on a, over the step that ended at the frame [N s]
};

/// Per-step figures, one entry per step.
struct StepTable {
  std::vector<double> time;      ///< at the end of the step [s]
  std::vector<double> dt;        ///< [s]
  std::vector<Vec3> energy;      ///< kinetic, potential, correction [J]
  std::vector<double> residual;  ///< [m/s]
  std::vector<std::uint32_t> contacts;
  std::vector<std::uint32_t> pairs;
  std::vector<Vec2> overlap;             ///< max, mean [m]
  std::vector<std::array<float, 4>> ms;  ///< collision, impulse, integration, other
};

/// An open recording. Small things are read at once, frames when asked for.
class RecordingReader {
 public:
  /// @throws FileError when the file is missing, no recording, damaged, or of another version
  explicit RecordingReader(const std::string& path);
  ~RecordingReader();
  RecordingReader(RecordingReader&&) noexcept;

  const std::string& path() const;
  /// Of the program that recorded.
  const std::string& version() const;
  const std::string& scene_path() const;
  const std::string& scene_text() const;
  const std::vector<std::string>& overrides() const;
  const std::string& settings_json() const;
  /// JSON of the run's summary; "" when the run did not end in order.
  const std::string& certificate() const;
  double fps() const;
  bool has_checkpoint() const;
  const std::vector<model::Material>& materials() const;
  const std::vector<RecordedBody>& bodies() const;
  const std::vector<RecordedShape>& shapes() const;

  std::size_t frame_count() const;
  /// Time of every frame [s].
  const std::vector<double>& frame_times() const;
  /// @throws FileError also when the number is too large
  Frame frame(std::size_t number) const;
  std::vector<RecordedContact> contacts(std::size_t number) const;
  StepTable steps() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace gotai::recording
