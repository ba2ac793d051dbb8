/// @file
/// Drawings of chapters 2 to 5, each made from what the engine itself computes and checked by one
/// number of it.
#pragma once

#include <string>
#include <vector>

#include "svg.h"
#include "thesis/scenario.h"

namespace gotai::experiments {

/// A finished drawing and the number that shows it is the engine's.
struct Drawing {
  std::string svg;
  bool as_expected = false;
  std::string found;
};

/// One figure of the thesis.
struct Figure {
  const char* number;  ///< "3-4"
  const char* title;
  const char* check;  ///< what must hold
  Drawing (*draw)();
};

/// Figs. 3-1..3-6, 4-1, 4-2: voxels and their descents.
std::vector<Figure> voxel_figures();
/// Figs. 2-2, 4-3, 4-4, 4-7, 4-8, 4-10: impulses and steps.
std::vector<Figure> contact_figures();
/// Figs. 5-1..5-5: apparent contact points.
std::vector<Figure> apparent_figures();
/// Figs. 2-1, 4-9, 5-6: flow charts with the times and counts of a run.
std::vector<Figure> flow_figures();

inline constexpr const char* kInk = "#333";
inline constexpr const char* kSoft = "#9aa5b1";
inline constexpr const char* kBody = "#e4572e";
inline constexpr const char* kBodyFill = "#f6c9b8";
inline constexpr const char* kVoxel = "#1f6fb4";
inline constexpr const char* kVoxelFill = "#bcd7ee";
inline constexpr const char* kGood = "#2a9d64";

/// Boxes from top to bottom with arrows between them; every box has a head and a line of figures.
struct FlowBox {
  std::string head;
  std::string figures;
};
/// @param back_to  the last box leads back to this one; -1: nowhere
std::string flow_chart(const std::vector<FlowBox>& boxes, int back_to);

}  // namespace gotai::experiments
