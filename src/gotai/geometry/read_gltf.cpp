// glTF 2.0 (Khronos): the triangles of the default scene with the transforms of their nodes.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "gotai/core/error.h"
#include "gotai/geometry/gltf_data.h"

namespace gotai::geometry::detail {

namespace {

using nlohmann::json;

class GltfReader {
 public:
  explicit GltfReader(const Source& source)
      : data_(source), most_corners_(std::max<std::size_t>(30'000'000, source.bytes.size())) {
    out_.format = source.bytes.starts_with("glTF") ? "glTF (binary)" : "glTF";
    out_.up = 'y';
  }

  Import read() {
    for (const std::size_t root : roots()) add_nodes(root);
    if (ignored_ > 0)
      out_.notes.push_back(fmt::format("{} primitives of points or lines were ignored", ignored_));
    if (skinned_) out_.notes.emplace_back("skins were ignored: the bind pose was read");
    return std::move(out_);
  }

 private:
  struct Task {
    std::size_t node;
    Eigen::Matrix4d transform;
  };

  std::vector<std::size_t> roots() const {
    const json& document = data_.document();
    if (document.contains("scenes") && !document.at("scenes").empty()) {
      const json& scene = data_.entry("scenes", data_.whole_number(document, "scene", 0));
      return indices(scene, "nodes");
    }
    // Without scenes: every node that is nobody's child.
    const std::size_t count = document.contains("nodes") ? document.at("nodes").size() : 0;
    std::vector<bool> is_child(count, false);
    for (std::size_t i = 0; i < count; ++i)
      for (const std::size_t child : children(data_.entry("nodes", i)))
        if (child < count) is_child[child] = true;
    std::vector<std::size_t> result;
    for (std::size_t i = 0; i < count; ++i)
      if (!is_child[i]) result.push_back(i);
    return result;
  }

  std::vector<std::size_t> children(const json& node) const { return indices(node, "children"); }

  /// The array `name` of indices; empty when there is none.
  std::vector<std::size_t> indices(const json& object, const char* name) const {
    std::vector<std::size_t> result;
    if (!object.contains(name)) return result;
    for (const json& index : object.at(name)) result.push_back(data_.whole_number(index));
    return result;
  }

  Eigen::Matrix4d transform_of(const json& node) const {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    const auto numbers = [&](const char* name, std::size_t count, std::vector<double> own) {
      std::vector<double> values = node.value(name, std::move(own));
      if (values.size() != count)
        data_.fail(fmt::format("a node's {} must be {} numbers", name, count));
      return values;
    };
    if (node.contains("matrix")) {
      const std::vector<double> values = numbers("matrix", 16, {});
      std::copy(values.begin(), values.end(), m.data());  // both are column by column
      return m;
    }
    const std::vector<double> t = numbers("translation", 3, {0, 0, 0});
    const std::vector<double> q = numbers("rotation", 4, {0, 0, 0, 1});  // x, y, z, w
    const std::vector<double> s = numbers("scale", 3, {1, 1, 1});
    m.topLeftCorner<3, 3>() = Quat(q[3], q[0], q[1], q[2]).normalized().toRotationMatrix() *
                              Vec3(s[0], s[1], s[2]).asDiagonal();
    m.topRightCorner<3, 1>() = Vec3(t[0], t[1], t[2]);
    return m;
  }

  /// The tree below a root, without recursion. A node that is met twice belongs to two parents or
  /// is its own ancestor: neither is allowed.
  void add_nodes(std::size_t root) {
    std::vector<Task> tasks = {{root, Eigen::Matrix4d::Identity()}};
    while (!tasks.empty()) {
      const Task task = tasks.back();
      tasks.pop_back();
      const json& node = data_.entry("nodes", task.node);
      visited_.resize(data_.document().at("nodes").size(), false);
      if (visited_[task.node])
        data_.fail(fmt::format("node {} has two parents or is its own ancestor", task.node));
      visited_[task.node] = true;
      const Eigen::Matrix4d transform = task.transform * transform_of(node);
      if (node.contains("mesh")) add_mesh(data_.whole_number(node.at("mesh")), transform);
      skinned_ |= node.contains("skin");
      const std::vector<std::size_t> below = children(node);
      for (auto child = below.rbegin(); child != below.rend(); ++child)
        tasks.push_back({*child, transform});
    }
  }

  void add_mesh(std::size_t mesh, const Eigen::Matrix4d& transform) {
    for (const json& primitive : data_.entry("meshes", mesh).at("primitives"))
      add_primitive(primitive, transform);
  }

  void add_primitive(const json& primitive, const Eigen::Matrix4d& transform) {
    const std::uint64_t mode = data_.whole_number(primitive, "mode", 4);
    if (mode < 4 || mode > 6) {
      ++ignored_;
      return;
    }
    if (primitive.contains("extensions"))
      for (const char* packed : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
        if (primitive.at("extensions").contains(packed))
          data_.fail(fmt::format("uses {}; export the mesh without compression", packed));
    const std::vector<double> positions =
        data_.read_accessor(data_.whole_number(primitive.at("attributes").at("POSITION")), 3);
    const std::size_t count = positions.size() / 3;
    std::vector<double> indices;
    if (primitive.contains("indices"))
      indices = data_.read_accessor(data_.whole_number(primitive.at("indices")), 1);
    else
      for (std::size_t i = 0; i < count; ++i) indices.push_back(static_cast<double>(i));
    if (out_.corners.size() + 3 * (count + indices.size()) > most_corners_)
      data_.fail("copies of its meshes make it too large; export it as one mesh");

    const std::size_t base = out_.vertices.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 p(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
      out_.vertices.emplace_back((transform * p.homogeneous()).head<3>());
    }
    for (const double index : indices)
      if (!(index >= 0.0 && index < static_cast<double>(count)))
        data_.fail(fmt::format("an index is {}, but there are {} vertices", index, count));
    const bool mirrored = transform.topLeftCorner<3, 3>().determinant() < 0.0;
    add_triangles(mode, indices, base, mirrored);
  }

  void add_triangles(std::uint64_t mode, const std::vector<double>& indices, std::size_t base,
                     bool mirrored) {
    const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
      if (mirrored) std::swap(b, c);
      for (const std::size_t k : {a, b, c})
        out_.corners.push_back(
            static_cast<std::uint32_t>(base + static_cast<std::size_t>(indices[k])));
      out_.end_polygon();
    };
    const std::size_t n = indices.size();
    for (std::size_t i = 0; mode == 4 && i + 2 < n; i += 3) add(i, i + 1, i + 2);
    for (std::size_t i = 0; mode == 5 && i + 2 < n; ++i)
      i % 2 == 0 ? add(i, i + 1, i + 2) : add(i, i + 2, i + 1);
    for (std::size_t i = 1; mode == 6 && i + 1 < n; ++i) add(0, i, i + 1);
  }

  GltfData data_;
  std::size_t most_corners_;
  std::vector<bool> visited_;
  std::size_t ignored_ = 0;
  bool skinned_ = false;
  Import out_;
};

}  // namespace

Import read_gltf(const Source& source) {
  try {
    return GltfReader(source).read();
  } catch (const json::exception& error) {
    throw FileError(source.path.string(), fmt::format("is no valid glTF: {}", error.what()));
  }
}

}  // namespace gotai::geometry::detail
