/// @file
/// Contacts of many frames, packed within a budget. Internal to view.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gotai/view/container.h"
#include "gotai/view/run_view.h"
#include "gotai/view/scale.h"

namespace gotai::view {

/// Indices of the contacts with the largest impulses, in their own order.
std::vector<std::size_t> strongest(const ContactsView& contacts, std::size_t count);

/// Where contacts lie and how many there are, frame by frame.
class ContactRanges {
 public:
  void extend(const ContactsView& contacts);
  const Box3& box() const { return box_; }
  std::size_t total() const { return total_; }
  std::size_t most() const { return most_; }
  /// Largest number per frame for which all frames together keep at most `budget` contacts.
  std::size_t limit(std::size_t budget) const;

 private:
  Box3 box_;
  std::vector<std::size_t> counts_;
  std::size_t total_ = 0;
  std::size_t most_ = 0;
};

class ContactPacker {
 public:
  /// @param bytes  that all frames together may take
  ContactPacker(std::string name, const ContactRanges& ranges, std::size_t bodies,
                std::size_t bytes);
  /// Contacts that a frame may keep.
  std::size_t limit() const { return limit_; }
  void add(const ContactsView& contacts);
  /// Adds the arrays and returns their header.
  nlohmann::json finish(ContainerWriter& container) const;

 private:
  std::string name_;
  PositionScale scale_;
  std::size_t limit_;
  std::vector<std::uint32_t> offset_{0};
  std::vector<std::uint32_t> body_;
  std::vector<std::uint32_t> point_;
  std::vector<std::int16_t> normal_;
  std::vector<std::uint16_t> impulse_;
  std::vector<std::uint16_t> gap_;
  bool narrow_bodies_;
};

}  // namespace gotai::view
