// VTK's XML PolyData with raw appended data: https://docs.vtk.org, "VTK XML Formats".
#include <fmt/format.h>

#include <cstdint>
#include <filesystem>
#include <type_traits>
#include <vector>

#include "gotai/core/error.h"
#include "gotai/recording/export.h"
#include "gotai/recording/float_vectors.h"
#include "gotai/recording/output_stream.h"
#include "gotai/recording/surroundings.h"

namespace gotai::recording {
namespace {

/// One .vtp file: declare arrays in the order of the sections, then write.
class PolyData {
 public:
  /// @param primitives  "Polys" or "Verts"
  PolyData(std::size_t points, std::size_t cells, const char* primitives)
      : points_(points), cells_(cells), primitives_(primitives) {}

  template <typename T>
  std::string array(const char* name, std::size_t components, const std::vector<T>& values) {
    const std::uint64_t size = values.size() * sizeof(T);
    std::string xml = fmt::format(
        R"(<DataArray type="{}" Name="{}" NumberOfComponents="{}" format="appended" offset="{}"/>)",
        std::is_same_v<T, float> ? "Float32" : "Int32", name, components, data_.size());
    data_.append(reinterpret_cast<const char*>(&size), sizeof size);
    data_.append(reinterpret_cast<const char*>(values.data()), size);
    return xml + "\n";
  }

  void write(const std::string& path, const std::string& sections) const {
    const bool polys = std::string_view(primitives_) == "Polys";
    OutputStream out(path);
    out.stream() << R"(<?xml version="1.0"?>)"
                 << "\n"
                 << R"(<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" )"
                 << R"(header_type="UInt64">)"
                 << "\n<PolyData>\n"
                 << fmt::format(
                        R"(<Piece NumberOfPoints="{}" NumberOfVerts="{}" NumberOfLines="0" )"
                        R"(NumberOfStrips="0" NumberOfPolys="{}">)",
                        points_, polys ? 0 : cells_, polys ? cells_ : 0)
                 << "\n"
                 << sections << "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" << data_
                 << "\n</AppendedData>\n</VTKFile>\n";
    out.commit();
  }

 private:
  std::size_t points_;
  std::size_t cells_;
  const char* primitives_;
  std::string data_;
};

std::vector<std::int32_t> multiples(std::size_t count, std::int32_t step) {
  std::vector<std::int32_t> out(count);
  for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<std::int32_t>(i + 1) * step;
  return out;
}

void write_bodies(const RecordingReader& recording, const std::vector<geometry::Mesh>& drawings,
                  std::size_t number, const std::string& path) {
  const Frame frame = recording.frame(number);
  std::vector<float> points, velocities;
  std::vector<std::int32_t> corners, body, material;
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const Pose& X = frame.poses[i];
    if (!X.p.allFinite()) continue;  // removed
    const auto first = static_cast<std::int32_t>(points.size() / 3);
    const Vec3 center = X * recording.bodies()[i].center_of_mass;
    for (const Vec3& vertex : drawings[i].vertices) {
      const Vec3 x = X * vertex;
      push(points, x);
      push(velocities, frame.v_W[i] + frame.w_W[i].cross(x - center));
    }
    for (const auto& triangle : drawings[i].triangles) {
      for (const std::uint32_t v : triangle)
        corners.push_back(first + static_cast<std::int32_t>(v));
      body.push_back(static_cast<std::int32_t>(i));
      material.push_back(static_cast<std::int32_t>(recording.bodies()[i].material));
    }
  }
  PolyData file(points.size() / 3, body.size(), "Polys");
  std::string xml = "<PointData Vectors=\"velocity\">\n" + file.array("velocity", 3, velocities);
  xml += "</PointData>\n<CellData>\n" + file.array("body", 1, body);
  xml += file.array("material", 1, material) + "</CellData>\n<Points>\n";
  xml += file.array("points", 3, points) + "</Points>\n<Polys>\n";
  xml += file.array("connectivity", 1, corners);
  xml += file.array("offsets", 1, multiples(body.size(), 3)) + "</Polys>\n";
  file.write(path, xml);
}

void write_contacts(const RecordingReader& recording, std::size_t number, const std::string& path) {
  const std::vector<RecordedContact> contacts = recording.contacts(number);
  std::vector<float> points, normals, impulses, gaps;
  std::vector<std::int32_t> body_a, body_b, vertices;
  for (const RecordedContact& contact : contacts) {
    vertices.push_back(static_cast<std::int32_t>(vertices.size()));
    push(points, contact.point_W);
    push(normals, contact.normal_W);
    push(impulses, contact.impulse_W);
    gaps.push_back(static_cast<float>(contact.gap));
    body_a.push_back(static_cast<std::int32_t>(contact.body_a));
    body_b.push_back(static_cast<std::int32_t>(contact.body_b));
  }
  PolyData file(contacts.size(), contacts.size(), "Verts");
  std::string xml = "<PointData Vectors=\"impulse\" Normals=\"normal\" Scalars=\"gap\">\n";
  xml += file.array("normal", 3, normals) + file.array("impulse", 3, impulses);
  xml += file.array("gap", 1, gaps) + file.array("body_a", 1, body_a);
  xml += file.array("body_b", 1, body_b) + "</PointData>\n<Points>\n";
  xml += file.array("points", 3, points) + "</Points>\n<Verts>\n";
  xml += file.array("connectivity", 1, vertices);
  xml += file.array("offsets", 1, multiples(contacts.size(), 1)) + "</Verts>\n";
  file.write(path, xml);
}

}  // namespace

void export_vtk(const RecordingReader& recording, const std::string& path) {
  const std::filesystem::path index(path);
  const std::filesystem::path folder = index.parent_path() / index.stem();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw FileError(folder.string(), "cannot be made: " + error.message());

  const double plane_edge = plane_half_edge(recording);
  std::vector<geometry::Mesh> drawings;
  for (std::size_t i = 0; i < recording.bodies().size(); ++i) {
    drawings.push_back(drawing_of(recording, i, plane_edge));
  }
  std::string entries;
  for (std::size_t f = 0; f < recording.frame_count(); ++f) {
    const std::string bodies = fmt::format("frame_{:06}.vtp", f);
    const std::string contacts = fmt::format("contacts_{:06}.vtp", f);
    write_bodies(recording, drawings, f, (folder / bodies).string());
    write_contacts(recording, f, (folder / contacts).string());
    int part = 0;
    for (const auto& [name, file] : {std::pair{"bodies", bodies}, {"contacts", contacts}}) {
      entries +=
          fmt::format(R"(<DataSet timestep="{}" group="" part="{}" name="{}" file="{}/{}"/>)",
                      recording.frame_times()[f], part++, name, folder.filename().string(), file);
      entries += '\n';
    }
  }
  OutputStream out(path);
  out.stream() << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
                  "byte_order=\"LittleEndian\">\n<Collection>\n"
               << entries << "</Collection>\n</VTKFile>\n";
  out.commit();
}

}  // namespace gotai::recording
