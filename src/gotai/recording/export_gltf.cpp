// glTF through tinygltf, which only this file knows.
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#include <fmt/format.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "gotai/core/error.h"
#include "gotai/recording/export.h"
#include "gotai/recording/float_vectors.h"
#include "gotai/recording/output_stream.h"
#include "gotai/recording/surroundings.h"
#include "gotai/recording/thin_keys.h"

namespace gotai::recording {
namespace {

/// Farthest vertex from the mesh frame's origin [m].
double reach_of(const geometry::Mesh& mesh) {
  double squared = 0.0;
  for (const Vec3& v : mesh.vertices) squared = std::max(squared, v.squaredNorm());
  return std::sqrt(squared);
}

double diagonal_of(const geometry::Mesh& mesh) {
  Box3 box;
  for (const Vec3& v : mesh.vertices) box.extend(v);
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

/// The poses of one body at the frames at which it exists, signs of neighbours aligned.
struct Track {
  std::vector<double> times;
  std::vector<Vec3> positions;
  std::vector<Quat> rotations;
};

std::vector<Track> read_tracks(const RecordingReader& recording) {
  std::vector<Track> tracks(recording.bodies().size());
  for (std::size_t f = 0; f < recording.frame_count(); ++f) {
    const Frame frame = recording.frame(f);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
      if (!frame.poses[i].p.allFinite()) continue;
      Quat q = frame.poses[i].q;
      if (!tracks[i].rotations.empty() && tracks[i].rotations.back().dot(q) < 0.0) {
        q.coeffs() = -q.coeffs();
      }
      tracks[i].times.push_back(frame.time);
      tracks[i].positions.push_back(frame.poses[i].p);
      tracks[i].rotations.push_back(q);
    }
  }
  return tracks;
}

/// A glTF document under construction.
class Document {
 public:
  Document() {
    model_.asset.version = "2.0";
    model_.asset.generator = "gotai";
    model_.buffers.resize(1);
    tinygltf::Node root;
    root.name = "z up to y up";
    root.rotation = {-std::sqrt(0.5), 0.0, 0.0, std::sqrt(0.5)};
    model_.nodes.push_back(root);
    tinygltf::Scene scene;
    scene.nodes = {0};
    model_.scenes.push_back(scene);
    model_.defaultScene = 0;
  }

  int add_material(const std::string& name, const std::array<double, 3>& color, bool two_sided) {
    tinygltf::Material material;
    material.name = name;
    material.pbrMetallicRoughness.baseColorFactor = {color[0], color[1], color[2], 1.0};
    material.pbrMetallicRoughness.metallicFactor = 0.0;
    material.pbrMetallicRoughness.roughnessFactor = 0.8;
    material.doubleSided = two_sided;
    model_.materials.push_back(material);
    return static_cast<int>(model_.materials.size()) - 1;
  }

  /// Vertices and indices; shared by all meshes that use the result.
  tinygltf::Primitive add_surface(const geometry::Mesh& mesh) {
    std::vector<float> positions;
    for (const Vec3& v : mesh.vertices) push(positions, v);
    std::vector<std::uint32_t> indices;
    for (const auto& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
    tinygltf::Primitive primitive;
    primitive.mode = TINYGLTF_MODE_TRIANGLES;
    primitive.attributes["POSITION"] =
        add_floats(positions, 3, TINYGLTF_TYPE_VEC3, TINYGLTF_TARGET_ARRAY_BUFFER, true);
    primitive.indices = add_indices(indices);
    return primitive;
  }

  int add_mesh(const std::string& name, tinygltf::Primitive primitive, int material) {
    primitive.material = material;
    tinygltf::Mesh mesh;
    mesh.name = name;
    mesh.primitives.push_back(std::move(primitive));
    model_.meshes.push_back(std::move(mesh));
    return static_cast<int>(model_.meshes.size()) - 1;
  }

  int add_node(const std::string& name, int mesh, const Vec3& p, const Quat& q) {
    tinygltf::Node node;
    node.name = name;
    node.mesh = mesh;
    node.translation = {p.x(), p.y(), p.z()};
    node.rotation = {q.x(), q.y(), q.z(), q.w()};
    model_.nodes.push_back(std::move(node));
    const int index = static_cast<int>(model_.nodes.size()) - 1;
    model_.nodes.front().children.push_back(index);
    return index;
  }

  /// Animates one property of a node.
  void add_channel(int node, const char* property, const std::vector<float>& times,
                   const std::vector<float>& values, int width) {
    if (model_.animations.empty()) {
      model_.animations.emplace_back();
      model_.animations.back().name = "simulation";
    }
    tinygltf::Animation& animation = model_.animations.back();
    tinygltf::AnimationSampler sampler;
    sampler.input = add_floats(times, 1, TINYGLTF_TYPE_SCALAR, 0, true);
    sampler.output =
        add_floats(values, width, width == 3 ? TINYGLTF_TYPE_VEC3 : TINYGLTF_TYPE_VEC4, 0, false);
    sampler.interpolation = "LINEAR";
    animation.samplers.push_back(sampler);
    tinygltf::AnimationChannel channel;
    channel.sampler = static_cast<int>(animation.samplers.size()) - 1;
    channel.target_node = node;
    channel.target_path = property;
    animation.channels.push_back(channel);
  }

  void write(const std::string& path, bool binary) {
    tinygltf::TinyGLTF writer;
    OutputStream out(path);
    if (!writer.WriteGltfSceneToStream(&model_, out.stream(), !binary, binary)) {
      throw FileError(path, "cannot be written");
    }
    out.commit();
  }

 private:
  template <typename T>
  int add_view(const std::vector<T>& values, int target) {
    std::vector<unsigned char>& data = model_.buffers.front().data;
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = values.size() * sizeof(T);
    view.target = target;
    const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
    data.insert(data.end(), bytes, bytes + view.byteLength);
    model_.bufferViews.push_back(view);
    return static_cast<int>(model_.bufferViews.size()) - 1;
  }

  int add_floats(const std::vector<float>& values, int width, int type, int target, bool bounds) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(values, target);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_FLOAT;
    accessor.type = type;
    accessor.count = values.size() / static_cast<std::size_t>(width);
    if (bounds) {
      const auto n = static_cast<std::size_t>(width);
      accessor.minValues.assign(n, std::numeric_limits<double>::max());
      accessor.maxValues.assign(n, std::numeric_limits<double>::lowest());
      for (std::size_t i = 0; i < values.size(); ++i) {
        const auto value = static_cast<double>(values[i]);
        accessor.minValues[i % n] = std::min(accessor.minValues[i % n], value);
        accessor.maxValues[i % n] = std::max(accessor.maxValues[i % n], value);
      }
    }
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  int add_indices(const std::vector<std::uint32_t>& indices) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(indices, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    accessor.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
    accessor.type = TINYGLTF_TYPE_SCALAR;
    accessor.count = indices.size();
    model_.accessors.push_back(accessor);
    return static_cast<int>(model_.accessors.size()) - 1;
  }

  tinygltf::Model model_;
};

void animate(Document& document, int node, const Track& track, double diagonal, double reach,
             double tolerance) {
  // Half of the tolerance each: translation, and what a rotation does to the farthest vertex.
  const double slack = 0.5 * tolerance * diagonal;
  const auto p_keys = thin_positions(track.times, track.positions, slack);
  const auto q_keys = thin_rotations(track.times, track.rotations, slack / reach);
  std::vector<float> times;
  std::vector<float> values;
  if (p_keys.size() > 1) {
    for (const std::size_t key : p_keys) {
      times.push_back(static_cast<float>(track.times[key]));
      push(values, track.positions[key]);
    }
    document.add_channel(node, "translation", times, values, 3);
  }
  if (q_keys.size() > 1) {
    times.clear();
    values.clear();
    for (const std::size_t key : q_keys) {
      times.push_back(static_cast<float>(track.times[key]));
      for (int k = 0; k < 4; ++k) {  // x, y, z, w
        values.push_back(static_cast<float>(track.rotations[key].coeffs()[k]));
      }
    }
    document.add_channel(node, "rotation", times, values, 4);
  }
}

}  // namespace

void export_gltf(const RecordingReader& recording, const std::string& path, double tolerance) {
  constexpr std::array<std::array<double, 3>, 6> kColors = {{{0.80, 0.36, 0.24},
                                                             {0.25, 0.47, 0.73},
                                                             {0.86, 0.66, 0.25},
                                                             {0.37, 0.60, 0.38},
                                                             {0.55, 0.42, 0.65},
                                                             {0.52, 0.55, 0.58}}};
  const std::vector<Track> tracks = read_tracks(recording);
  Document document;
  std::map<std::uint32_t, tinygltf::Primitive> surfaces;          // by shape
  std::map<std::uint32_t, int> materials;                         // by material
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> meshes;  // by shape and material
  const double plane_edge = plane_half_edge(recording);
  int ground = -1;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const RecordedBody& body = recording.bodies()[i];
    const Track& track = tracks[i];
    if (track.times.empty()) continue;
    if (body.geometry != model::Geometry::shape) {
      if (ground < 0) ground = document.add_material("surroundings", {0.7, 0.7, 0.7}, true);
      const geometry::Mesh mesh = drawing_of(recording, i, plane_edge);
      const int id = document.add_mesh(body.name, document.add_surface(mesh), ground);
      document.add_node(body.name, id, track.positions.front(), track.rotations.front());
      continue;
    }
    const RecordedShape& shape = recording.shapes()[body.shape];
    if (shape.mesh.triangles.empty()) continue;
    if (!surfaces.contains(body.shape)) {
      surfaces[body.shape] = document.add_surface(shape.mesh);
    }
    if (!materials.contains(body.material)) {
      const std::string name = body.material < recording.materials().size()
                                   ? recording.materials()[body.material].name
                                   : fmt::format("material {}", body.material);
      materials[body.material] =
          document.add_material(name, kColors[materials.size() % kColors.size()], false);
    }
    const std::pair key(body.shape, body.material);
    if (!meshes.contains(key)) {
      meshes[key] = document.add_mesh(shape.name, surfaces[body.shape], materials[body.material]);
    }
    const int node =
        document.add_node(body.name, meshes[key], track.positions.front(), track.rotations.front());
    animate(document, node, track, diagonal_of(shape.mesh), reach_of(shape.mesh), tolerance);
  }
  document.write(path, !path.ends_with(".gltf") && !path.ends_with(".GLTF"));
}

}  // namespace gotai::recording
