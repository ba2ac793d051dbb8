#include "gotai/recording/layout.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

namespace gotai::recording::layout {
namespace {

std::vector<double> flat(const std::vector<Vec3>& points) {
  std::vector<double> numbers;
  numbers.reserve(3 * points.size());
  for (const Vec3& p : points) numbers.insert(numbers.end(), {p.x(), p.y(), p.z()});
  return numbers;
}

template <typename Simplex>
std::vector<std::uint32_t> flat(const std::vector<Simplex>& simplices) {
  std::vector<std::uint32_t> indices;
  indices.reserve(simplices.size() * std::tuple_size_v<Simplex>);
  for (const Simplex& simplex : simplices) {
    indices.insert(indices.end(), simplex.begin(), simplex.end());
  }
  return indices;
}

std::string settings_json(const model::Settings& s) {
  const nlohmann::ordered_json json = {
      {"gravity", {s.gravity.x(), s.gravity.y(), s.gravity.z()}},
      {"collision", {{"model", model::to_string(s.collision.model)}, {"level", s.collision.level}}},
      {"impulse",
       {{"method", model::to_string(s.impulse.method)},
        {"contacts", model::to_string(s.impulse.contacts)},
        {"solver", model::to_string(s.impulse.solver)},
        {"ridge", s.impulse.ridge},
        {"tolerance", s.impulse.tolerance},
        {"max_iterations", s.impulse.max_iterations},
        {"penetration", s.impulse.penetration},
        {"tension", s.impulse.tension},
        {"rolling_resistance", s.impulse.rolling_resistance}}},
      {"time",
       {{"step", s.time.step},
        {"safety", s.time.safety},
        {"max_step", s.time.max_step},
        {"integrator", model::to_string(s.time.integrator)}}}};
  return json.dump();
}

void write_materials(Hdf5File& file, const model::MaterialTable& table) {
  std::vector<std::string> names;
  std::vector<double> numbers;
  for (const model::Material& m : table.materials) {
    names.push_back(m.name);
    numbers.insert(numbers.end(), {m.restitution, m.friction, m.density});
  }
  file.write_texts("/materials/name", kNameWidth, names);
  file.write("/materials/restitution_friction_density", {names.size(), 3}, numbers);
}

}  // namespace

std::vector<Table> frame_tables(std::uint64_t bodies) {
  const std::uint64_t rows = bodies > 500 ? 1 : 16;
  return {{"/frames/t", Scalar::f64, {}, 1024},
          {"/frames/step", Scalar::u64, {}, 1024},
          {"/frames/pose", Scalar::f64, {bodies, 7}, rows},
          {"/frames/velocity", Scalar::f64, {bodies, 6}, rows}};
}

const std::vector<Table>& body_tables() {
  static const std::vector<Table> tables = {{"/bodies/id", Scalar::u32, {}, 256},
                                            {"/bodies/kind", Scalar::u8, {}, 256},
                                            {"/bodies/geometry", Scalar::u8, {}, 256},
                                            {"/bodies/shape", Scalar::u32, {}, 256},
                                            {"/bodies/material", Scalar::u32, {}, 256},
                                            {"/bodies/mass", Scalar::f64, {}, 256},
                                            {"/bodies/center_of_mass", Scalar::f64, {3}, 256},
                                            {"/bodies/half_extent", Scalar::f64, {3}, 256},
                                            {"/bodies/bounding_radius", Scalar::f64, {}, 256}};
  return tables;
}

const std::vector<Table>& contact_tables() {
  static const std::vector<Table> tables = {
      {"/contacts/offset", Scalar::u64, {}, 1024}, {"/contacts/pair", Scalar::u32, {2}, 4096},
      {"/contacts/point", Scalar::f32, {3}, 4096}, {"/contacts/normal", Scalar::f32, {3}, 4096},
      {"/contacts/gap", Scalar::f32, {}, 4096},    {"/contacts/impulse", Scalar::f32, {3}, 4096}};
  return tables;
}

const std::vector<Table>& step_tables() {
  static const std::vector<Table> tables = {
      {"/steps/t", Scalar::f64, {}, 1024},        {"/steps/dt", Scalar::f64, {}, 1024},
      {"/steps/energy", Scalar::f64, {3}, 1024},  {"/steps/residual", Scalar::f64, {}, 1024},
      {"/steps/contacts", Scalar::u32, {}, 1024}, {"/steps/pairs", Scalar::u32, {}, 1024},
      {"/steps/overlap", Scalar::f64, {2}, 1024}, {"/steps/ms", Scalar::f32, {4}, 1024}};
  return tables;
}

void write_start(Hdf5File& file, const World& world, const SceneSource& scene,
                 const RecorderOptions& options) {
  file.write_text("/format", kFormat);
  file.write_text("/version", GOTAI_VERSION);
  // Absolute: resuming may happen in another folder.
  file.write_text("/scene/path",
                  scene.path.empty() ? "" : std::filesystem::absolute(scene.path).string());
  file.write_text("/scene/text", scene.text);
  std::string overrides;
  for (const std::string& assignment : scene.overrides) overrides += assignment + "\n";
  file.write_text("/scene/overrides", overrides);
  file.write_text("/scene/settings", settings_json(world.settings()));
  file.write<double>("/scene/fps", {1}, {options.fps});
  write_materials(file, world.materials());

  file.create_text_table("/bodies/name", kNameWidth, 256);
  file.create_text_table("/frames/hash", kHashWidth, 1024);
  std::vector<Table> tables = frame_tables(world.bodies().size());
  for (const auto* more : {&body_tables(), &contact_tables(), &step_tables()}) {
    tables.insert(tables.end(), more->begin(), more->end());
  }
  for (const Table& table : tables) {
    file.create_table(table.name, table.scalar, table.row, table.chunk_rows);
  }
  file.create_table("/checkpoint/state", Scalar::u8, {}, 65536);
}

void append_bodies(Hdf5File& file, const World& world,
                   const std::vector<model::BodyIndex>& columns) {
  const model::BodyState& bodies = world.bodies();
  std::vector<std::string> names;
  std::vector<std::uint32_t> ids, shapes, materials;
  std::vector<std::uint8_t> kinds, geometries;
  std::vector<double> masses, radii;
  std::vector<Vec3> centers, half_extents;
  for (const model::BodyIndex i : columns) {
    names.push_back(world.body_name(i));
    ids.push_back(world.id(i).value);
    kinds.push_back(static_cast<std::uint8_t>(bodies.kind[i]));
    geometries.push_back(static_cast<std::uint8_t>(bodies.geometry[i]));
    shapes.push_back(bodies.shape[i]);
    materials.push_back(bodies.material[i]);
    masses.push_back(bodies.is_dynamic(i) ? 1.0 / bodies.inverse_mass[i] : 0.0);
    centers.push_back(bodies.p_MB[i]);
    half_extents.push_back(bodies.half_extent[i]);
    radii.push_back(bodies.bounding_radius[i]);
  }
  file.append_texts("/bodies/name", names);
  file.append_rows("/bodies/id", ids);
  file.append_rows("/bodies/kind", kinds);
  file.append_rows("/bodies/geometry", geometries);
  file.append_rows("/bodies/shape", shapes);
  file.append_rows("/bodies/material", materials);
  file.append_rows("/bodies/mass", masses);
  file.append_rows("/bodies/center_of_mass", flat(centers));
  file.append_rows("/bodies/half_extent", flat(half_extents));
  file.append_rows("/bodies/bounding_radius", radii);
}

void write_shape(Hdf5File& file, std::size_t number, const voxel::Shape& shape) {
  const std::string group = fmt::format("/shapes/{}", number);
  file.write_text(group + "/name", shape.name);
  file.write_text(group + "/content", shape.content.hex());
  file.write(group + "/vertices", {shape.mesh.vertices.size(), 3}, flat(shape.mesh.vertices));
  file.write(group + "/triangles", {shape.mesh.triangles.size(), 3}, flat(shape.mesh.triangles));
  file.write<double>(group + "/volume", {1}, {shape.mass.volume});
  const Vec3& center = shape.mass.center_of_mass;
  file.write<double>(group + "/center_of_mass", {3}, {center.x(), center.y(), center.z()});
  const voxel::VoxelGrid& grid = shape.pyramid.grid;
  file.write<double>(group + "/voxels/origin_edge", {4},
                     {grid.origin.x(), grid.origin.y(), grid.origin.z(), grid.edge});
  for (int h = 1; h <= shape.pyramid.max_level(); ++h) {
    std::vector<std::uint16_t> indices;
    for (const auto& index : shape.pyramid.level(h).index) {
      indices.insert(indices.end(), index.begin(), index.end());
    }
    file.write(fmt::format("{}/voxels/level_{}", group, h), {indices.size() / 3, 3}, indices);
  }
}

}  // namespace gotai::recording::layout
