#include "summary_text.h"

#include <fmt/format.h>

#include <cmath>

#include "console.h"

namespace gotai::cli {

nlohmann::ordered_json to_json(const RunSummary& s) {
  return {
      {"bodies", s.bodies},
      {"steps", s.steps},
      {"simulated_s", s.simulated_s},
      {"wall_s", s.wall_s},
      {"step_ms",
       {{"mean", s.step_ms.mean},
        {"p95", s.step_ms.p95},
        {"max", s.step_ms.max},
        {"last_second_mean", s.step_ms.last_second_mean}}},
      {"phase_ms",
       {{"collision", s.phase_ms.collision},
        {"impulse", s.phase_ms.impulse},
        {"integration", s.phase_ms.integration},
        {"other", s.phase_ms.other}}},
      {"contacts", {{"mean", s.contacts.mean}, {"max", s.contacts.max}}},
      {"overlap", {{"max", s.overlap.max}, {"mean", s.overlap.mean}}},
      {"true_overlap",
       {{"touching", s.true_overlap.touching},
        {"mean", s.true_overlap.mean},
        {"p99", s.true_overlap.p99},
        {"max", s.true_overlap.max},
        {"max_m", s.true_overlap.max_m},
        {"gap3", s.true_overlap.gap3}}},
      {"step_margin", std::isfinite(s.step_margin) ? nlohmann::ordered_json(s.step_margin)
                                                   : nlohmann::ordered_json(nullptr)},
      {"energy",
       {{"initial", s.energy.initial}, {"final", s.energy.final}, {"max_gain", s.energy.max_gain}}},
      {"momentum_error", s.momentum_error},
      {"residual_max", s.residual_max},
      {"plastic_islands", s.plastic_islands},
      {"substeps_max", s.substeps_max},
      {"escaped", s.escaped},
      {"state_hash", s.state_hash},
  };
}

std::string to_table(const RunSummary& s) {
  Report report;
  report.row("simulated", fmt::format("{:.4g} s in {} steps, {} bodies", s.simulated_s,
                                      format_count(s.steps), format_count(s.bodies)));
  report.row("took", fmt::format("{} ({:.3g} times real time)", format_duration(s.wall_s),
                                 s.wall_s > 0.0 ? s.simulated_s / s.wall_s : 0.0));
  report.row("per step",
             fmt::format("{:.3g} ms mean, {:.3g} ms 95 %, {:.3g} ms max, {:.3g} ms in "
                         "the last second",
                         s.step_ms.mean, s.step_ms.p95, s.step_ms.max, s.step_ms.last_second_mean));
  report.row("phases", fmt::format("collision {:.3g} ms, impulse {:.3g} ms, integration {:.3g} ms, "
                                   "other {:.3g} ms",
                                   s.phase_ms.collision, s.phase_ms.impulse, s.phase_ms.integration,
                                   s.phase_ms.other));
  report.row("contacts",
             fmt::format("{:.4g} mean, {} max", s.contacts.mean, format_count(s.contacts.max)));
  report.row("overlap", fmt::format("{} mean, {} max (the collision model's own)",
                                    format_length(s.overlap.mean), format_length(s.overlap.max)));
  const TrueOverlap& v = s.true_overlap;
  report.row("true overlap",
             fmt::format("{:.3g} % mean, {:.3g} % 99 %, {:.3g} % max ({}) of the size, {} pairs; "
                         "gap to the third neighbour {:+.2g} %",
                         100.0 * v.mean, 100.0 * v.p99, 100.0 * v.max, format_length(v.max_m),
                         format_count(v.touching), 100.0 * v.gap3));
  if (std::isfinite(s.step_margin)) {
    report.row("step margin", fmt::format("{:.3g} (below 1: some point moved farther than a "
                                          "voxel's radius in a step)",
                                          s.step_margin));
  }
  report.row("energy", fmt::format("{:.6g} J to {:.6g} J, largest gain {:.2g} J", s.energy.initial,
                                   s.energy.final, s.energy.max_gain));
  report.row("momentum error", fmt::format("{:.2g} of the largest momentum", s.momentum_error));
  report.row(
      "solver",
      fmt::format("residual {:.2g} m/s max, {} sub-steps per step at most, {} islands without "
                  "restitution",
                  s.residual_max, format_count(s.substeps_max),
                  s.plastic_islands == 0 ? "no" : format_count(s.plastic_islands)));
  report.row("escaped", s.escaped == 0 ? "none" : format_count(s.escaped) + " bodies");
  report.row("state hash", s.state_hash);
  return report.text();
}

}  // namespace gotai::cli
