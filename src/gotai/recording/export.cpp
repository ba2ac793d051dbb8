#include "gotai/recording/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>

#include "gotai/core/error.h"
#include "gotai/recording/output_stream.h"

namespace gotai::recording {

void export_csv(const RecordingReader& recording, const std::string& path) {
  OutputStream out(path);
  out.stream() << "time,body,px,py,pz,qw,qx,qy,qz\n";
  std::string lines;
  for (std::size_t f = 0; f < recording.frame_count(); ++f) {
    const Frame frame = recording.frame(f);
    lines.clear();
    for (std::size_t i = 0; i < frame.poses.size(); ++i) {
      const Pose& X = frame.poses[i];
      if (recording.bodies()[i].geometry != model::Geometry::shape || !X.p.allFinite()) continue;
      // fmt writes the shortest text that reads back exactly.
      fmt::format_to(std::back_inserter(lines), "{},{},{},{},{},{},{},{},{}\n", frame.time, i,
                     X.p.x(), X.p.y(), X.p.z(), X.q.w(), X.q.x(), X.q.y(), X.q.z());
    }
    out.stream() << lines;
  }
  out.commit();
}

void export_recording(const RecordingReader& recording, const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (extension == ".csv") return export_csv(recording, path);
  if (extension == ".glb" || extension == ".gltf") return export_gltf(recording, path);
  if (extension == ".pvd") return export_vtk(recording, path);
  throw FileError(path, fmt::format("\"{}\" is no format to export to; use .csv (table), .glb or "
                                    ".gltf (animation), .pvd (ParaView)",
                                    extension));
}

}  // namespace gotai::recording
