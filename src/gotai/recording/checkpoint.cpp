#include "gotai/recording/checkpoint.h"

#include <fmt/format.h>

#include <cstring>
#include <type_traits>

#include "gotai/core/error.h"
#include "gotai/core/hash.h"

namespace gotai::recording {
namespace {

constexpr std::uint32_t kVersion = 2;

/// Appends the fields of a checkpoint. `visit` below drives writer and reader alike, so that they
/// cannot disagree.
class Writer {
 public:
  template <typename T>
  void number(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    raw(&value, sizeof value);
  }
  template <typename T>
  void array(const std::vector<T>& values) {
    number(static_cast<std::uint64_t>(values.size()));
    raw(values.data(), values.size() * sizeof(T));
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  void raw(const void* data, std::size_t size) {
    const auto* begin = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), begin, begin + size);
  }
  std::vector<std::uint8_t> bytes_;
};

class Reader {
 public:
  Reader(const std::vector<std::uint8_t>& bytes, std::size_t end, const std::string& path)
      : bytes_(bytes), end_(end), path_(path) {}

  template <typename T>
  void number(T& value) {
    raw(&value, sizeof value);
  }
  template <typename T>
  void array(std::vector<T>& values) {
    std::uint64_t size = 0;
    number(size);
    if (size > (end_ - next_) / sizeof(T)) fail();
    values.resize(size);
    raw(values.data(), size * sizeof(T));
  }
  bool is_at_end() const { return next_ == end_; }
  [[noreturn]] void fail() const { throw FileError(path_, "its checkpoint is damaged"); }

 private:
  void raw(void* out, std::size_t size) {
    if (size > end_ - next_) fail();
    if (size > 0) std::memcpy(out, bytes_.data() + next_, size);
    next_ += size;
  }
  const std::vector<std::uint8_t>& bytes_;
  std::size_t next_ = 0;
  std::size_t end_;
  const std::string& path_;
};

using Numbers = std::vector<double>;

Numbers pack(const std::vector<Vec3>& vectors) {
  Numbers numbers;
  for (const Vec3& v : vectors) numbers.insert(numbers.end(), {v.x(), v.y(), v.z()});
  return numbers;
}

Numbers pack(const std::vector<Quat>& rotations) {
  Numbers numbers;
  for (const Quat& q : rotations) numbers.insert(numbers.end(), {q.w(), q.x(), q.y(), q.z()});
  return numbers;
}

void unpack(const Numbers& numbers, std::vector<Vec3>& vectors) {
  vectors.clear();
  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
    vectors.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
  }
}

void unpack(const Numbers& numbers, std::vector<Quat>& rotations) {
  rotations.clear();
  for (std::size_t i = 0; i + 3 < numbers.size(); i += 4) {
    rotations.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2], numbers[i + 3]);
  }
}

/// The contact memory as arrays without padding.
struct PackedMemory {
  std::vector<std::uint32_t> pairs;
  std::vector<std::uint64_t> features;
  Numbers impulses;
};

PackedMemory pack(const model::ContactMemory& memory) {
  PackedMemory packed;
  for (const auto& entry : memory.entries) {
    packed.pairs.insert(packed.pairs.end(), {entry.body_a, entry.body_b});
    packed.features.push_back(entry.feature);
    const Vec3& p = entry.impulse_W;
    packed.impulses.insert(packed.impulses.end(), {p.x(), p.y(), p.z()});
  }
  return packed;
}

bool unpack(const PackedMemory& packed, model::ContactMemory& memory) {
  const std::size_t n = packed.features.size();
  if (packed.pairs.size() != 2 * n || packed.impulses.size() != 3 * n) return false;
  memory.entries.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double* p = packed.impulses.data() + 3 * i;
    memory.entries[i] = {packed.pairs[2 * i], packed.pairs[2 * i + 1], packed.features[i],
                         Vec3(p[0], p[1], p[2])};
  }
  return true;
}

/// The contact anchors as arrays without padding.
struct PackedAnchors {
  static constexpr std::size_t kPerPair = 8;
  static constexpr std::size_t kPerContact = 13;
  std::vector<std::uint32_t> pairs;  // body a, body b, contacts
  Numbers poses;                     // p, q (w, x, y, z), reach
  std::vector<std::uint64_t> features;
  Numbers contacts;  // points on a and b, normal, point of friction, area
};

PackedAnchors pack(const model::ContactAnchors& anchors) {
  PackedAnchors packed;
  for (const model::ContactAnchors::Pair& pair : anchors.pairs) {
    const auto count = static_cast<std::uint32_t>(pair.contacts.size());
    packed.pairs.insert(packed.pairs.end(), {pair.body_a, pair.body_b, count});
    const Vec3& p = pair.X_BA.p;
    const Quat& q = pair.X_BA.q;
    packed.poses.insert(packed.poses.end(),
                        {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), pair.reach});
    for (const model::ContactAnchors::Contact& c : pair.contacts) {
      packed.features.push_back(c.feature);
      for (const Vec3& v : {c.point_A, c.point_B, c.normal_B, c.friction_A}) {
        packed.contacts.insert(packed.contacts.end(), {v.x(), v.y(), v.z()});
      }
      packed.contacts.push_back(c.area);
    }
  }
  return packed;
}

bool unpack(const PackedAnchors& packed, model::ContactAnchors& anchors) {
  const std::size_t n = packed.pairs.size() / 3;
  const std::size_t contacts = packed.features.size();
  if (packed.pairs.size() != 3 * n || packed.poses.size() != PackedAnchors::kPerPair * n ||
      packed.contacts.size() != PackedAnchors::kPerContact * contacts) {
    return false;
  }
  anchors.pairs.resize(n);
  std::size_t next = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint32_t* pair = packed.pairs.data() + 3 * i;
    const double* x = packed.poses.data() + PackedAnchors::kPerPair * i;
    if (pair[2] > contacts - next) return false;
    anchors.pairs[i] = {
        pair[0], pair[1], {Vec3(x[0], x[1], x[2]), Quat(x[3], x[4], x[5], x[6])}, x[7], {}};
    for (const std::size_t end = next + pair[2]; next < end; ++next) {
      const double* c = packed.contacts.data() + PackedAnchors::kPerContact * next;
      anchors.pairs[i].contacts.push_back({Vec3(c[0], c[1], c[2]), Vec3(c[3], c[4], c[5]),
                                           Vec3(c[6], c[7], c[8]), Vec3(c[9], c[10], c[11]), c[12],
                                           packed.features[next]});
    }
  }
  return next == contacts;
}

/// Everything of a checkpoint as numbers and arrays.
struct Packed {
  std::uint32_t version = kVersion;
  std::uint64_t frames = 0, steps = 0, contacts = 0, step_count = 0;
  double time = 0.0, last_dt = 0.0;
  std::vector<std::uint32_t> ids;
  std::vector<char> state_hash;
  Numbers x, q, v, L, w;
  PackedMemory memory;
  PackedAnchors anchors;

  template <typename Stream>
  void visit(Stream& stream) {
    for (std::uint64_t* n : {&frames, &steps, &contacts, &step_count}) stream.number(*n);
    stream.number(time);
    stream.number(last_dt);
    stream.array(ids);
    stream.array(state_hash);
    for (Numbers* numbers : {&x, &q, &v, &L, &w, &memory.impulses}) stream.array(*numbers);
    stream.array(memory.pairs);
    stream.array(memory.features);
    stream.array(anchors.pairs);
    stream.array(anchors.features);
    stream.array(anchors.poses);
    stream.array(anchors.contacts);
  }
};

Hash128 checksum(const std::uint8_t* bytes, std::size_t size) {
  return Hasher().bytes(bytes, size).digest();
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const Checkpoint& checkpoint) {
  const Snapshot& s = checkpoint.snapshot;
  Packed packed;
  packed.frames = checkpoint.frames;
  packed.steps = checkpoint.steps;
  packed.contacts = checkpoint.contacts;
  packed.step_count = s.step_count;
  packed.time = s.time;
  packed.last_dt = s.last_dt;
  packed.ids = checkpoint.ids;
  packed.state_hash.assign(checkpoint.state_hash.begin(), checkpoint.state_hash.end());
  packed.x = pack(s.x_W);
  packed.q = pack(s.q_WB);
  packed.v = pack(s.v_W);
  packed.L = pack(s.L_W);
  packed.w = pack(s.w_W);
  packed.memory = pack(s.memory);
  packed.anchors = pack(s.anchors);
  Writer writer;
  writer.number(packed.version);
  packed.visit(writer);
  std::vector<std::uint8_t> bytes = writer.take();
  const Hash128 hash = checksum(bytes.data(), bytes.size());
  const auto* begin = reinterpret_cast<const std::uint8_t*>(&hash);
  bytes.insert(bytes.end(), begin, begin + sizeof hash);
  return bytes;
}

Checkpoint from_bytes(const std::vector<std::uint8_t>& bytes, const std::string& path) {
  if (bytes.empty()) throw FileError(path, "has no checkpoint to resume from");
  const std::size_t size = bytes.size() - std::min(bytes.size(), sizeof(Hash128));
  Reader reader(bytes, size, path);
  Hash128 hash;
  if (bytes.size() < sizeof hash) reader.fail();
  std::memcpy(&hash, bytes.data() + size, sizeof hash);
  if (!(hash == checksum(bytes.data(), size))) reader.fail();

  Packed packed;
  reader.number(packed.version);
  if (packed.version != kVersion) {
    throw FileError(path, fmt::format("its checkpoint has format {}, and this version goes on from "
                                      "format {}; run the scene again",
                                      packed.version, kVersion));
  }
  packed.visit(reader);
  Checkpoint out;
  Snapshot& s = out.snapshot;
  const std::size_t n = packed.ids.size();
  const bool sizes_agree = packed.x.size() == 3 * n && packed.q.size() == 4 * n &&
                           packed.v.size() == 3 * n && packed.L.size() == 3 * n &&
                           packed.w.size() == 3 * n;
  if (!reader.is_at_end() || !sizes_agree || !unpack(packed.memory, s.memory) ||
      !unpack(packed.anchors, s.anchors)) {
    reader.fail();
  }
  unpack(packed.x, s.x_W);
  unpack(packed.q, s.q_WB);
  unpack(packed.v, s.v_W);
  unpack(packed.L, s.L_W);
  unpack(packed.w, s.w_W);
  s.time = packed.time;
  s.last_dt = packed.last_dt;
  s.step_count = packed.step_count;
  out.frames = packed.frames;
  out.steps = packed.steps;
  out.contacts = packed.contacts;
  out.ids = std::move(packed.ids);
  out.state_hash.assign(packed.state_hash.begin(), packed.state_hash.end());
  return out;
}

}  // namespace gotai::recording
