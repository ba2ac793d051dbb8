#include "gotai/recording/recording_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "gotai/core/error.h"
#include "gotai/recording/hdf5_file.h"
#include "gotai/recording/layout.h"

namespace gotai::recording {
namespace {

std::vector<Vec3> to_vectors(const std::vector<double>& numbers) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
    out.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  }
  return out;
}

template <typename Number>
Vec3 vector_at(const std::vector<Number>& numbers, std::size_t i) {
  return Vec3(static_cast<double>(numbers[3 * i]), static_cast<double>(numbers[3 * i + 1]),
              static_cast<double>(numbers[3 * i + 2]));
}

std::vector<model::Material> read_materials(const Hdf5File& file) {
  const auto names = file.read_texts("/materials/name");
  const auto numbers =
      file.read_rows<double>("/materials/restitution_friction_density", {3}, 0, names.size());
  std::vector<model::Material> materials;
  for (std::size_t i = 0; i < names.size(); ++i) {
    materials.push_back({names[i], numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]});
  }
  return materials;
}

std::vector<RecordedBody> read_bodies(const Hdf5File& file, std::size_t shapes) {
  const auto names = file.read_texts("/bodies/name");
  const std::size_t n = names.size();
  const auto kind = file.read_rows<std::uint8_t>("/bodies/kind", {}, 0, n);
  const auto geometry = file.read_rows<std::uint8_t>("/bodies/geometry", {}, 0, n);
  const auto shape = file.read_rows<std::uint32_t>("/bodies/shape", {}, 0, n);
  const auto material = file.read_rows<std::uint32_t>("/bodies/material", {}, 0, n);
  const auto mass = file.read_rows<double>("/bodies/mass", {}, 0, n);
  const auto center = file.read_rows<double>("/bodies/center_of_mass", {3}, 0, n);
  const auto half = file.read_rows<double>("/bodies/half_extent", {3}, 0, n);
  const auto radius = file.read_rows<double>("/bodies/bounding_radius", {}, 0, n);
  std::vector<RecordedBody> bodies;
  for (std::size_t i = 0; i < n; ++i) {
    if (kind[i] > static_cast<std::uint8_t>(model::BodyKind::kinematic) ||
        geometry[i] > static_cast<std::uint8_t>(model::Geometry::container)) {
      throw FileError(file.path(), fmt::format("body {} is of an unknown kind", i));
    }
    const auto form = static_cast<model::Geometry>(geometry[i]);
    if (form == model::Geometry::shape && shape[i] >= shapes) {
      throw FileError(file.path(), fmt::format("body {} has the unknown shape {}", i, shape[i]));
    }
    bodies.push_back({names[i], static_cast<model::BodyKind>(kind[i]), form, shape[i], material[i],
                      mass[i], vector_at(center, i), vector_at(half, i), radius[i]});
  }
  return bodies;
}

RecordedShape read_shape(const Hdf5File& file, const std::string& group) {
  RecordedShape shape;
  shape.name = file.read_text(group + "/name");
  shape.content = file.read_text(group + "/content");
  shape.mesh.vertices = to_vectors(file.read_all<double>(group + "/vertices", {3}));
  const auto indices = file.read_all<std::uint32_t>(group + "/triangles", {3});
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    shape.mesh.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  }
  const std::size_t vertices = shape.mesh.vertices.size();
  if (std::any_of(indices.begin(), indices.end(), [&](auto index) { return index >= vertices; })) {
    throw FileError(file.path(), "a triangle of " + group + " has a vertex that does not exist");
  }
  shape.volume = file.read_rows<double>(group + "/volume", {}, 0, 1).front();
  shape.center_of_mass = vector_at(file.read_rows<double>(group + "/center_of_mass", {}, 0, 3), 0);
  const auto grid = file.read_rows<double>(group + "/voxels/origin_edge", {}, 0, 4);
  shape.grid.origin = vector_at(grid, 0);
  shape.grid.edge = grid[3];
  for (int h = 1; h <= voxel::kMaxLevel; ++h) {
    const std::string name = fmt::format("{}/voxels/level_{}", group, h);
    if (!file.exists(name)) break;
    const auto numbers = file.read_all<std::uint16_t>(name, {3});
    auto& level = shape.voxels.emplace_back();
    for (std::size_t i = 0; i < numbers.size(); i += 3) {
      level.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
    }
  }
  return shape;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

}  // namespace

struct RecordingReader::State {
  explicit State(const std::string& path) : file(Hdf5File::read(path)) {}

  Hdf5File file;
  std::string version, scene_path, scene_text, settings, certificate;
  std::vector<std::string> overrides;
  double fps = 0.0;
  std::vector<model::Material> materials;
  std::vector<RecordedShape> shapes;
  std::vector<RecordedBody> bodies;
  std::vector<double> times;
};

RecordingReader::RecordingReader(const std::string& path) : state_(std::make_unique<State>(path)) {
  State& s = *state_;
  const Hdf5File& file = s.file;
  if (!file.exists("/format")) throw FileError(path, "is no recording of gotai");
  const std::string format = file.read_text("/format");
  if (format != layout::kFormat) {
    throw FileError(
        path, fmt::format("is a \"{:.40}\"; this program reads \"{}\"", format, layout::kFormat));
  }
  s.version = file.read_text("/version");
  s.scene_path = file.read_text("/scene/path");
  s.scene_text = file.read_text("/scene/text");
  s.overrides = lines_of(file.read_text("/scene/overrides"));
  s.settings = file.read_text("/scene/settings");
  s.fps = file.read_rows<double>("/scene/fps", {}, 0, 1).front();
  if (file.exists("/certificate")) s.certificate = file.read_text("/certificate");
  s.materials = read_materials(file);
  for (std::size_t i = 0; file.exists(fmt::format("/shapes/{}", i)); ++i) {
    s.shapes.push_back(read_shape(file, fmt::format("/shapes/{}", i)));
  }
  s.bodies = read_bodies(file, s.shapes.size());
  s.times = file.read_all<double>("/frames/t", {});
}

RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;

const std::string& RecordingReader::path() const { return state_->file.path(); }
const std::string& RecordingReader::version() const { return state_->version; }
const std::string& RecordingReader::scene_path() const { return state_->scene_path; }
const std::string& RecordingReader::scene_text() const { return state_->scene_text; }
const std::vector<std::string>& RecordingReader::overrides() const { return state_->overrides; }
const std::string& RecordingReader::settings_json() const { return state_->settings; }
const std::string& RecordingReader::certificate() const { return state_->certificate; }
double RecordingReader::fps() const { return state_->fps; }
bool RecordingReader::has_checkpoint() const {
  const Extents extents = state_->file.extents("/checkpoint/state");
  return !extents.empty() && extents.front() > 0;
}
const std::vector<model::Material>& RecordingReader::materials() const { return state_->materials; }
const std::vector<RecordedBody>& RecordingReader::bodies() const { return state_->bodies; }
const std::vector<RecordedShape>& RecordingReader::shapes() const { return state_->shapes; }
std::size_t RecordingReader::frame_count() const { return state_->times.size(); }
const std::vector<double>& RecordingReader::frame_times() const { return state_->times; }

Frame RecordingReader::frame(std::size_t number) const {
  const Hdf5File& file = state_->file;
  const std::size_t n = state_->bodies.size();
  const auto pose = file.read_rows<double>("/frames/pose", {n, 7}, number, 1);
  const auto velocity = file.read_rows<double>("/frames/velocity", {n, 6}, number, 1);
  Frame frame;
  frame.time = file.read_rows<double>("/frames/t", {}, number, 1).front();
  frame.step = file.read_rows<std::uint64_t>("/frames/step", {}, number, 1).front();
  frame.state_hash = file.read_text_row("/frames/hash", number);
  for (std::size_t i = 0; i < n; ++i) {
    const double* p = pose.data() + 7 * i;
    const double* v = velocity.data() + 6 * i;
    frame.poses.push_back({Vec3(p[0], p[1], p[2]), Quat(p[3], p[4], p[5], p[6])});
    frame.v_W.emplace_back(v[0], v[1], v[2]);
    frame.w_W.emplace_back(v[3], v[4], v[5]);
  }
  return frame;
}

std::vector<RecordedContact> RecordingReader::contacts(std::size_t number) const {
  const Hdf5File& file = state_->file;
  const auto range = file.read_rows<std::uint64_t>("/contacts/offset", {}, number, 2);
  if (range[1] < range[0]) throw FileError(path(), "its contact offsets are damaged");
  const std::uint64_t count = range[1] - range[0];
  const auto pair = file.read_rows<std::uint32_t>("/contacts/pair", {2}, range[0], count);
  const auto point = file.read_rows<float>("/contacts/point", {3}, range[0], count);
  const auto normal = file.read_rows<float>("/contacts/normal", {3}, range[0], count);
  const auto gap = file.read_rows<float>("/contacts/gap", {}, range[0], count);
  const auto impulse = file.read_rows<float>("/contacts/impulse", {3}, range[0], count);
  std::vector<RecordedContact> contacts;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::max(pair[2 * i], pair[2 * i + 1]) >= state_->bodies.size()) {
      throw FileError(path(), "a contact has a body that does not exist");
    }
    contacts.push_back({pair[2 * i], pair[2 * i + 1], vector_at(point, i), vector_at(normal, i),
                        static_cast<double>(gap[i]), vector_at(impulse, i)});
  }
  return contacts;
}

StepTable RecordingReader::steps() const {
  const Hdf5File& file = state_->file;
  StepTable table;
  table.time = file.read_all<double>("/steps/t", {});
  const std::size_t n = table.time.size();
  table.dt = file.read_rows<double>("/steps/dt", {}, 0, n);
  table.energy = to_vectors(file.read_rows<double>("/steps/energy", {3}, 0, n));
  table.residual = file.read_rows<double>("/steps/residual", {}, 0, n);
  table.contacts = file.read_rows<std::uint32_t>("/steps/contacts", {}, 0, n);
  table.pairs = file.read_rows<std::uint32_t>("/steps/pairs", {}, 0, n);
  const auto overlap = file.read_rows<double>("/steps/overlap", {2}, 0, n);
  const auto ms = file.read_rows<float>("/steps/ms", {4}, 0, n);
  for (std::size_t i = 0; i < n; ++i) {
    table.overlap.emplace_back(overlap[2 * i], overlap[2 * i + 1]);
    table.ms.push_back({ms[4 * i], ms[4 * i + 1], ms[4 * i + 2], ms[4 * i + 3]});
  }
  return table;
}

}  // namespace gotai::recording
