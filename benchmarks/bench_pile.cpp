// PILE(mesh, N): copies of a mesh fall into a container and come to rest. Prints a table of time
// per step (processor) and of how far the true meshes overlap at the end, and beside it, if asked
// for, the same for other engines (--compare may be given twice).
//
//   bench_pile FOLDER MESH N [--seconds 5] [--level 6] [--contacts all|reduced] [--threads 1]
//              [--copies 1x1] [--shift 0] [--rolling 1e-4] [--repeat 1] [--compare ode|bullet]
//              [--verbose] [--unjudged]
//   bench_pile FOLDER MESH N --memory
//
// --copies 3x2 puts six copies of the pile side by side into one container; --shift 1e-7 starts all
// bodies so many metres further along x, for another run of the same kind; --rolling sets the
// rolling resistance; --repeat 5 runs the pile five times, the same to the last bit, and counts the
// least time of each step, so that a busy machine does not tell; --unjudged leaves out how far the
// meshes overlap, which takes longer than the run; --memory prints what shapes, bodies and contacts
// take instead of running for the time. FOLDER holds MESH.obj and MESH_N.csv: poses
// px,py,pz,qw,qx,qy,qz after a line
// "# bodies container_inner_edge_m container_height_m: N EDGE HEIGHT".
#include <fmt/format.h>

#include <string>
#include <vector>

#include "gotai/core/error.h"
#include "pile/pile.h"

namespace {

using namespace gotai;

pile::Options parse(int argc, char** argv) {
  if (argc < 4) {
    throw InvalidArgument("arguments", fmt::format("{}", argc - 1),
                          "bench_pile FOLDER MESH N [--seconds S] [--level L] [--contacts C] "
                          "[--threads T] [--copies XxY] [--shift M] [--rolling R] [--repeat R] "
                          "[--compare ode|bullet] [--verbose] [--unjudged] [--memory]");
  }
  pile::Options o;
  o.folder = argv[1];
  o.mesh = argv[2];
  o.bodies = std::stoi(argv[3]);
  for (int i = 4; i < argc; ++i) {
    const std::string key = argv[i];
    if (key == "--verbose") {
      o.verbose = true;
      continue;
    }
    if (key == "--unjudged") {
      o.judged = false;
      continue;
    }
    if (key == "--memory") {
      o.memory = true;
      continue;
    }
    if (++i == argc) throw InvalidArgument(key, "", "needs a value");
    const std::string value = argv[i];
    if (key == "--seconds") {
      o.seconds = std::stod(value);
    } else if (key == "--level") {
      o.level = std::stoi(value);
    } else if (key == "--repeat") {
      o.repeat = std::stoi(value);
    } else if (key == "--threads") {
      o.threads = std::stoi(value);
    } else if (key == "--copies") {
      const std::size_t by = value.find('x');
      if (by == std::string::npos) throw InvalidArgument(key, value, "must look like 3x2");
      o.copies_x = std::stoi(value.substr(0, by));
      o.copies_y = std::stoi(value.substr(by + 1));
    } else if (key == "--shift") {
      o.shift = std::stod(value);
    } else if (key == "--rolling") {
      o.rolling_resistance = std::stod(value);
    } else if (key == "--contacts") {
      o.contacts = model::parse_contact_treatment(value);
    } else if (key == "--compare") {
      pile::require_rival(value);
      o.compare.push_back(value);
    } else {
      throw InvalidArgument(key, value, "is not an option of bench_pile");
    }
  }
  return o;
}

void print_row(const pile::Options& o, const pile::Result& r) {
  const TrueOverlap& v = r.overlap;
  const std::string overlap =
      o.judged ? fmt::format("{:.4f} / {:.3f} / {:.3f} | {:+.4f}", 100.0 * v.mean, 100.0 * v.p99,
                             100.0 * v.max, 100.0 * v.gap3)
               : "not judged | ";
  const std::string lost = o.judged ? fmt::format("{} | {}", r.linked, r.escaped) : " | ";
  fmt::print(
      "| {} | {:.2f} | {:.2f} | {:.1f} | {:.0f} | {:.2f} / {:.2f} | {} | {:.1e} | {} | {:.1e} |\n",
      r.engine, r.ms_per_step, r.ms_last_second, r.ms_worst, r.contacts, r.us_per_contact,
      r.us_per_contact_last_second, overlap, r.rms_speed, lost, r.energy_gain);
}

void print_memory(const pile::Options& o) {
  const pile::Memory m = pile::measure_memory(o, pile::read_pile(o));
  fmt::print(
      "{}, level {}: {:.0f} KB per shape: itself {:.0f} KB (of it the surface model {:.0f} KB), "
      "prepared by a world {:.0f} KB; body {:.0f} bytes, contact {:.0f} bytes\n",
      o.mesh, o.level, (m.shape + m.prepared) / 1024.0, m.shape / 1024.0, m.surface_model / 1024.0,
      m.prepared / 1024.0, m.per_body, m.per_contact);
}

void run(const pile::Options& o) {
  if (o.memory) {
    print_memory(o);
    return;
  }
  const pile::Pile pile = pile::read_pile(o);
  pile::Result ours = pile::run_gotai(o, pile);
  if (o.judged) pile::judge(pile, ours);
  std::vector<pile::Result> others;
  for (const std::string& name : o.compare) {
    others.push_back(pile::run_rival(name, o, pile));
    if (o.judged) pile::judge(pile, others.back());
  }
  fmt::print("\nPILE({}, {}), level {}, contacts {}, {:g} s\n", o.mesh, o.bodies, o.level,
             model::to_string(o.contacts), o.seconds);
  fmt::print(
      "| engine | ms per step | last second | worst | contacts | us per contact, last second | "
      "penetration % mean / p99 / "
      "max | gap3 % | rms speed m/s | linked | escaped | energy gain |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  print_row(o, ours);
  for (const pile::Result& theirs : others) print_row(o, theirs);
  for (const pile::Result& theirs : others) {
    fmt::print(
        "gotai is {:.1f} times as fast as {} over the run, {:.1f} times in the last second, and "
        "overlaps {:.1f} times less in the mean\n",
        theirs.ms_per_step / ours.ms_per_step, theirs.engine,
        theirs.ms_last_second / ours.ms_last_second, theirs.overlap.mean / ours.overlap.mean);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
  return 0;
}
