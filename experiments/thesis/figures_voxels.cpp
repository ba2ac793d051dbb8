// Figs. 3-1..3-6, 4-1, 4-2: voxels, the in-out test, the pyramid, the descent.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "gotai/collision/sphere_descent.h"
#include "gotai/voxel/pyramid2.h"
#include "thesis/figures.h"

namespace gotai::experiments {
namespace {

geometry::Mesh2 plane_shape(const char* name) {
  geometry::GeneratorOptions options;
  options.shape = name;
  return geometry::generate_plane(options);
}

void draw_mesh(SvgDrawing& svg, const geometry::Mesh2& mesh, const Vec2& shift) {
  for (const geometry::Triangle& t : mesh.triangles)
    svg.polygon(
        {mesh.vertices[t[0]] + shift, mesh.vertices[t[1]] + shift, mesh.vertices[t[2]] + shift},
        kBody, kBodyFill, 0.6);
}

void draw_square(SvgDrawing& svg, const voxel::SquareGrid& grid, int level, const Vec2& center,
                 const Vec2& shift, const char* fill, double width_px = 0.8) {
  const Vec2 half = Vec2::Constant(0.5 * grid.square_edge(level));
  svg.rectangle(center - half + shift, center + half + shift, kVoxel, fill, width_px);
}

void draw_border(SvgDrawing& svg, const voxel::Pyramid2& pyramid, int level, const Vec2& shift,
                 bool circles) {
  for (const Vec2& center : pyramid.level(level).center) {
    draw_square(svg, pyramid.grid, level, center, shift, circles ? "none" : kVoxelFill);
    if (circles) svg.circle(center + shift, pyramid.grid.square_radius(level), kVoxel, "none", 0.8);
  }
}

/// Every border square has a border child in the next level, and counts fall with the level.
bool is_pyramid(const voxel::Pyramid2& pyramid) {
  for (int h = 1; h < pyramid.max_level(); ++h) {
    const voxel::PyramidLevel2& level = pyramid.level(h);
    for (std::size_t i = 0; i < level.size(); ++i)
      if (level.first_child[i] == level.first_child[i + 1]) return false;
  }
  return pyramid.level(1).size() == 1;
}

std::string counts_of(const voxel::Pyramid2& pyramid) {
  std::string text;
  for (int h = 1; h <= pyramid.max_level(); ++h)
    text += fmt::format("{}{}", h > 1 ? ", " : "", pyramid.level(h).size());
  return text + " squares at levels 1.." + std::to_string(pyramid.max_level());
}

Drawing draw_3_1() {
  const geometry::Mesh2 mesh = plane_shape("cross");
  const voxel::Pyramid2 pyramid = voxel::make_pyramid2(mesh, 5);
  SvgDrawing svg(Vec2(-1.3, -1.25), Vec2(3.9, 1.35), 760.0);
  draw_mesh(svg, mesh, Vec2::Zero());
  draw_border(svg, pyramid, 5, Vec2::Zero(), false);
  draw_mesh(svg, mesh, Vec2(2.6, 0.0));
  draw_border(svg, pyramid, 5, Vec2(2.6, 0.0), true);
  svg.text(Vec2(0.0, 1.15), "border squares, level 5");
  svg.text(Vec2(2.6, 1.15), "their circles");
  return {svg.document(), is_pyramid(pyramid), counts_of(pyramid)};
}

/// Cubes of voxels, seen obliquely, the far ones first.
void draw_voxels(SvgDrawing& svg, const voxel::Pyramid& pyramid, int level, const Vec2& shift) {
  const Vec3 right = Vec3(1.0, -0.55, 0.0).normalized();
  const Vec3 up = Vec3(-0.25, -0.45, 1.0).normalized();
  const Vec3 toward(-0.5, -0.9, 0.55);
  const auto flat = [&](const Vec3& x) -> Vec2 { return Vec2(right.dot(x), up.dot(x)) + shift; };
  std::vector<Vec3> centers = pyramid.voxel_centers(level);
  std::sort(centers.begin(), centers.end(),
            [&](const Vec3& a, const Vec3& b) { return toward.dot(a) < toward.dot(b); });
  const double h = 0.5 * pyramid.grid.voxel_edge(level);
  for (const Vec3& c : centers) {
    const auto at = [&](double x, double y, double z) { return flat(c + h * Vec3(x, y, z)); };
    svg.polygon({at(-1, -1, 1), at(1, -1, 1), at(1, 1, 1), at(-1, 1, 1)}, kVoxel, "#dcebf8", 0.4);
    svg.polygon({at(-1, -1, -1), at(1, -1, -1), at(1, -1, 1), at(-1, -1, 1)}, kVoxel, "#a9cbe8",
                0.4);
    svg.polygon({at(-1, -1, -1), at(-1, 1, -1), at(-1, 1, 1), at(-1, -1, 1)}, kVoxel, "#7fb0da",
                0.4);
  }
}

Drawing draw_3_2() {
  geometry::GeneratorOptions options;
  options.shape = "hexapod";
  const auto shape = prepare(options, kFinestPrepared, Setup{});
  SvgDrawing svg(Vec2(-1.7, -1.7), Vec2(11.9, 1.9), 900.0);
  std::string counts;
  bool grows = true;
  for (int h = 2; h <= 5; ++h) {
    const Vec2 shift(3.4 * (h - 2), 0.0);
    draw_voxels(svg, shape->pyramid, h, shift);
    const std::size_t n = shape->pyramid.level(h).size();
    svg.text(Vec2(0.0, 1.6) + shift, fmt::format("level {}: {} voxels", h, n));
    counts += fmt::format("{}{}", h > 2 ? ", " : "", n);
    grows = grows && n > shape->pyramid.level(h - 1).size();
  }
  return {svg.document(), grows, counts + " voxels at levels 2..5"};
}

/// The test of Fig. 3-3 in the plane: a . b for the three edges of a triangle.
std::array<double, 3> edge_products(const std::array<Vec2, 3>& corner, const Vec2& center) {
  std::array<double, 3> products{};
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 along = corner[(k + 1) % 3] - corner[k];
    const Vec2 outward(along.y(), -along.x());
    products[k] = (corner[k] - center).dot(outward.normalized());
  }
  return products;
}

Drawing draw_3_3() {
  const std::array<Vec2, 3> corner{Vec2(-0.9, -0.8), Vec2(1.1, -0.6), Vec2(0.1, 1.0)};
  geometry::Mesh2 mesh;
  mesh.vertices.assign(corner.begin(), corner.end());
  mesh.triangles = {{0, 1, 2}};
  const voxel::SquareGrid grid = voxel::square_grid_around(mesh);
  constexpr int level = 4;
  SvgDrawing svg(Vec2(-1.2, -1.25), Vec2(3.2, 1.35), 720.0);
  draw_mesh(svg, mesh, Vec2::Zero());
  const std::vector<voxel::SquareIndex> inside = voxel::squares_inside(mesh, grid, level);
  std::size_t agree = 0;
  for (std::uint16_t j = 0; j < 8; ++j)
    for (std::uint16_t i = 0; i < 8; ++i) {
      const Vec2 center = grid.square_center(level, {i, j});
      const std::array<double, 3> products = edge_products(corner, center);
      const bool by_test = *std::min_element(products.begin(), products.end()) >= 0.0;
      const bool by_engine =
          std::find(inside.begin(), inside.end(), voxel::SquareIndex{i, j}) != inside.end();
      agree += by_test == by_engine ? 1 : 0;
      svg.circle(center, 0.03, by_engine ? kGood : kSoft, by_engine ? kGood : "#fff", 1.0);
    }
  for (const auto& [index, row] : {std::pair(voxel::SquareIndex{4, 3}, 0), {{1, 6}, 1}}) {
    const Vec2 center = grid.square_center(level, index);
    for (const Vec2& c : corner) svg.arrow(center, c, row == 0 ? kGood : kInk, 1.2);
    const std::array<double, 3> products = edge_products(corner, center);
    svg.text(Vec2(1.35, 0.6 - 0.8 * row),
             fmt::format("a.b = {:.2f}, {:.2f}, {:.2f}", products[0], products[1], products[2]),
             13.0, "start");
    svg.text(Vec2(1.35, 0.4 - 0.8 * row), row == 0 ? "all >= 0: inside" : "one < 0: outside", 13.0,
             "start", row == 0 ? kGood : kInk);
  }
  return {svg.document(), agree == 64, fmt::format("{} of 64 centres", agree)};
}

Drawing draw_3_4() {
  const geometry::Mesh2 mesh = plane_shape("circle");
  const voxel::Pyramid2 pyramid = voxel::make_pyramid2(mesh, 5);
  SvgDrawing svg(Vec2(-0.6, -0.6), Vec2(5.4, 0.75), 900.0);
  draw_mesh(svg, mesh, Vec2::Zero());
  for (const voxel::SquareIndex& index : voxel::squares_inside(mesh, pyramid.grid, 5))
    draw_square(svg, pyramid.grid, 5, pyramid.grid.square_center(5, index), Vec2::Zero(),
                kVoxelFill);
  svg.text(Vec2(0.0, 0.6), "inside, level 5");
  for (int h = 5; h >= 2; --h) {
    const Vec2 shift(1.2 * (6 - h), 0.0);
    draw_border(svg, pyramid, h, shift, false);
    svg.text(Vec2(0.0, 0.6) + shift, h == 5 ? "border" : fmt::format("merged: level {}", h));
  }
  return {svg.document(), is_pyramid(pyramid), counts_of(pyramid)};
}

/// Two equal balls that overlap a little.
collision::DescentTrace descent_of_balls(const voxel::Pyramid*& pyramid, Pose& X_BA) {
  geometry::GeneratorOptions options;
  options.shape = "sphere";
  static const auto shape = prepare(options, 6, Setup{});
  pyramid = &shape->pyramid;
  X_BA.p = Vec3(0.9, 0.35, 0.0);
  return collision::descend_with_trace(*pyramid, *pyramid, X_BA, 6, 0.0);
}

/// Overlapping pairs of a level, counted by testing every sphere with every other.
std::size_t count_all_pairs(const voxel::Pyramid& pyramid, const Pose& X_BA, int level) {
  std::size_t count = 0;
  const double reach = 2.0 * pyramid.grid.voxel_radius(level);
  const std::vector<Vec3> centers = pyramid.voxel_centers(level);
  for (const Vec3& a : centers)
    for (const Vec3& b : centers)
      if ((X_BA * a - b).norm() <= reach) ++count;
  return count;
}

Drawing draw_3_5() {
  const voxel::Pyramid* pyramid = nullptr;
  Pose X_BA;
  const collision::DescentTrace trace = descent_of_balls(pyramid, X_BA);
  std::vector<FlowBox> boxes;
  for (std::size_t h = 1; h <= trace.colliding.size(); ++h)
    boxes.push_back({fmt::format("N = {}: do the spheres of level {} overlap?", h, h),
                     fmt::format("{} tests, {} pairs overlap{}", trace.tests[h - 1],
                                 trace.colliding[h - 1].size(),
                                 h < trace.colliding.size() ? ": replace by their children" : "")});
  boxes.push_back({"N = k: these pairs are the contacts",
                   fmt::format("{} contacts", trace.colliding.back().size())});
  const std::size_t brute = count_all_pairs(*pyramid, X_BA, 6);
  return {flow_chart(boxes, -1), trace.colliding.size() == 6 && trace.colliding[5].size() == brute,
          fmt::format("{} by descent, {} by testing all", trace.colliding.back().size(), brute)};
}

Drawing draw_3_6() {
  const voxel::Pyramid* pyramid = nullptr;
  Pose X_BA;
  const collision::DescentTrace trace = descent_of_balls(pyramid, X_BA);
  SvgDrawing svg(Vec2(-0.95, -0.95), Vec2(10.6, 1.6), 960.0);
  bool nested = true;
  for (int h = 1; h <= 4; ++h) {
    const Vec2 shift(2.85 * (h - 1), 0.0);
    const double r = pyramid->grid.voxel_radius(h);
    std::vector<bool> hit_a(pyramid->level(h).size());
    std::vector<bool> hit_b(pyramid->level(h).size());
    for (const auto& pair : trace.colliding[static_cast<std::size_t>(h) - 1])
      hit_a[pair.a] = hit_b[pair.b] = true;
    nested = nested && !trace.colliding[static_cast<std::size_t>(h) - 1].empty();
    for (std::size_t i = 0; i < hit_a.size(); ++i) {
      const Vec3 a = X_BA * pyramid->voxel_center(h, i);
      const Vec3 b = pyramid->voxel_center(h, i);
      svg.circle(b.head<2>() + shift, r, hit_b[i] ? kVoxel : "#e3e6ea",
                 hit_b[i] ? kVoxelFill : "none", 0.7);
      svg.circle(a.head<2>() + shift, r, hit_a[i] ? kBody : "#e3e6ea",
                 hit_a[i] ? kBodyFill : "none", 0.7);
    }
    svg.text(Vec2(0.45, 1.42) + shift,
             fmt::format("level {}: {} pairs", h,
                         trace.colliding[static_cast<std::size_t>(h) - 1].size()));
  }
  return {svg.document(), nested,
          fmt::format("{} tests in all",
                      trace.tests[0] + trace.tests[1] + trace.tests[2] + trace.tests[3])};
}

Drawing draw_4_1() {
  SvgDrawing svg(Vec2(-0.7, -0.65), Vec2(4.5, 0.85), 820.0);
  std::string counts;
  bool in_grid = true;
  int column = 0;
  for (const char* name : {"square", "circle", "cross", "l"}) {
    geometry::Mesh2 mesh = plane_shape(name);
    const voxel::SquareGrid grid = voxel::square_grid_around(mesh);
    for (Vec2& v : mesh.vertices) v = (v - grid.origin) / grid.edge - Vec2::Constant(0.5);
    const voxel::Pyramid2 pyramid = voxel::make_pyramid2(mesh, 5);
    const Vec2 shift(1.27 * column, 0.0);
    draw_mesh(svg, mesh, shift);
    draw_border(svg, pyramid, 5, shift, false);
    svg.text(Vec2(0.0, 0.65) + shift, fmt::format("{} squares", pyramid.level(5).size()));
    counts += fmt::format("{}{} {}", column > 0 ? ", " : "", name, pyramid.level(5).size());
    in_grid = in_grid && pyramid.level(5).size() <= 256;
    ++column;
  }
  return {svg.document(), in_grid, counts + ", of 16 x 16"};
}

Drawing draw_4_2() {
  geometry::GeneratorOptions cube;
  SvgDrawing svg(Vec2(-0.65, -0.65), Vec2(3.25, 0.85), 820.0);
  std::string counts;
  bool squares = true;
  for (int level = 3; level <= 5; ++level) {
    Setup setup;
    setup.level = level;
    World world = world_with_floor(setup);
    const auto shape = prepare(cube, level, setup);
    const double z = touching_height(*shape, Quat::Identity(), setup) - 1e-9;
    add_unit_body(world, world.add_shape(shape), Vec3(0.0, 0.0, z));
    const model::ContactSet contacts = world.find_contacts_now();
    const Vec2 shift(1.3 * (level - 3), 0.0);
    svg.rectangle(Vec2(-0.5, -0.5) + shift, Vec2(0.5, 0.5) + shift, kBody, kBodyFill);
    for (const Vec3& p : contacts.point_W)
      svg.circle(p.head<2>() + shift, shape->pyramid.grid.voxel_radius(level), kVoxel, "none", 0.8);
    const std::size_t side = std::size_t{1} << (level - 1);
    svg.text(Vec2(0.0, 0.68) + shift, fmt::format("level {}: {} contacts", level, contacts.size()));
    counts += fmt::format("{}{}", level > 3 ? ", " : "", contacts.size());
    squares = squares && contacts.size() == side * side;
  }
  return {svg.document(), squares, counts};
}

}  // namespace

std::vector<Figure> voxel_figures() {
  return {{"3-1", "Voxel division in two dimensions", "every square has children", draw_3_1},
          {"3-2", "Voxel division in three dimensions", "voxels grow with the level", draw_3_2},
          {"3-3", "The in-out test", "the engine agrees with a.b >= 0 at every centre", draw_3_3},
          {"3-4", "How the voxel data is made: inside, border, merged four to one",
           "every square has children", draw_3_4},
          {"3-5", "Flow of the voxel-based collision detection",
           "the descent finds what testing all pairs finds", draw_3_5},
          {"3-6", "Stepwise collision detection of two balls", "pairs overlap at every level",
           draw_3_6},
          {"4-1", "Simple and complex shapes at one level", "never more than 16 x 16 squares",
           draw_4_1},
          {"4-2", "A face on the floor is 4 x 4, 8 x 8, 16 x 16 contacts", "16, 64, 256 contacts",
           draw_4_2}};
}

}  // namespace gotai::experiments
