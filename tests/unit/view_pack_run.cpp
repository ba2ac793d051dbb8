#include "gotai/view/pack_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "gotai/core/random.h"
#include "gotai/geometry/generate.h"
#include "gotai/view/page.h"

namespace gotai::view {
namespace {

/// Reads containers as viewer/src/data/container.ts describes them.
struct Reader {
  explicit Reader(const std::vector<std::uint8_t>& bytes) : data(bytes) {
    std::uint32_t length = 0;
    std::memcpy(&length, data.data() + 4, 4);
    EXPECT_EQ(std::memcmp(data.data(), "GTV1", 4), 0);
    header = nlohmann::json::parse(data.begin() + 8, data.begin() + 8 + length);
    start = (8 + std::size_t{length} + 7) / 8 * 8;
  }

  template <typename T>
  std::vector<T> array(const std::string& name) const {
    const nlohmann::json& entry = header.at("arrays").at(name);
    std::vector<T> values(entry.at("count").get<std::size_t>());
    const std::size_t offset = start + entry.at("offset").get<std::size_t>();
    EXPECT_EQ(offset % 8, 0U);
    EXPECT_LE(offset + values.size() * sizeof(T), data.size());
    std::memcpy(values.data(), data.data() + offset, values.size() * sizeof(T));
    if (const std::size_t stride = entry.value("stride", 0); stride > 0)
      for (std::size_t i = stride; i < values.size(); ++i)
        values[i] = static_cast<T>(values[i] + values[i - stride]);
    return values;
  }

  std::vector<std::uint8_t> data;
  nlohmann::json header;
  std::size_t start = 0;
};

ShapeView cube() {
  static const ShapeView shape = describe(
      voxel::make_shape("cube", geometry::generate({}), {.prepared_level = 4, .surface_level = 0}));
  return shape;
}

RunView make_run(std::size_t bodies) {
  RunView run;
  run.title = "test";
  run.shapes = {cube()};
  run.materials = {model::Material{}};
  for (std::size_t i = 0; i < bodies; ++i)
    run.bodies.push_back({.name = "body", .mass = 1.0, .radius = 0.87});
  run.bodies.push_back(
      {.name = "floor", .kind = model::BodyKind::fixed, .geometry = model::Geometry::plane});
  return run;
}

/// Bodies on the move at random, each with contacts on the floor, the last body.
FrameSource make_frames(std::size_t bodies, std::size_t frames, std::size_t contacts_per_body) {
  FrameSource source;
  for (std::size_t f = 0; f < frames; ++f) source.times.push_back(static_cast<double>(f) / 60.0);
  source.read = [=](std::size_t f) {
    Random random(f + 1);
    const auto vector = [&](double size) {
      return Vec3(random.uniform(-size, size), random.uniform(-size, size),
                  random.uniform(-size, size));
    };
    FrameView frame;
    frame.time = static_cast<double>(f) / 60.0;
    for (std::size_t i = 0; i <= bodies; ++i) {
      const Vec3 v = vector(1.0);
      frame.x_W.push_back(i == bodies ? Vec3(0.0, 0.0, -0.5) : vector(20.0));
      frame.q_WB.push_back(Quat(random.uniform(-1.0, 1.0), v.x(), v.y(), v.z()).normalized());
      frame.v_W.push_back(vector(9.0));
      frame.w_W.push_back(vector(30.0));
      if (i == bodies) continue;
      for (std::size_t c = 0; c < contacts_per_body; ++c) {
        frame.contacts.body.insert(frame.contacts.body.end(), {static_cast<std::uint32_t>(i),
                                                               static_cast<std::uint32_t>(bodies)});
        frame.contacts.point_W.push_back(vector(20.0));
        frame.contacts.normal_W.push_back(Vec3::UnitZ());
        frame.contacts.impulse_W.push_back(Vec3(0.0, 0.0, random.uniform(0.0, 4.0)));
        frame.contacts.gap.push_back(-0.001);
      }
    }
    return frame;
  };
  return source;
}

TEST(PackRun, KeepsPositionsWithinTheStatedError) {
  const RunView run = make_run(20);
  const FrameSource frames = make_frames(20, 30, 0);
  const Reader page(pack_run(run, frames, {}, {}, {}));
  const auto& scale = page.header["frames"]["position"];
  const auto packed = page.array<std::uint16_t>("frames.position");
  double worst = 0.0;
  for (std::size_t f = 0; f < 30; ++f) {
    const FrameView frame = frames.read(f);
    for (std::size_t i = 0; i < 20; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const double x = scale["origin"][k].get<double>() +
                         scale["step"][k].get<double>() * packed[3 * (f * 20 + i) + k];
        worst = std::max(worst, std::abs(x - frame.x_W[i][static_cast<int>(k)]));
      }
  }
  EXPECT_LT(worst, 1e-4 * 40.0);
  EXPECT_LT(worst, 0.5 * 40.0 / 65535.0 * 1.001);
  EXPECT_EQ(page.array<std::uint32_t>("frames.moving").size(), 20U);
  EXPECT_EQ(page.array<float>("bodies.pose")[7 * 20 + 2], -0.5F);
  EXPECT_THAT(page.header["notes"].dump(), testing::HasSubstr("within"));
}

TEST(PackRun, TakesMoreBitsWhenABodyIsSmallForTheScene) {
  RunView run = make_run(2);
  run.bodies[1].radius = 1e-3;
  const Reader page(pack_run(run, make_frames(2, 3, 0), {}, {}, {}));
  EXPECT_EQ(page.header["arrays"]["frames.position"]["type"], "u32");
}

TEST(PackRun, ThousandBodiesAndThreeHundredFramesFitIntoThirtyMegabytes) {
  // Random poses and contacts deflate worst.
  const Reader page(pack_run(make_run(1000), make_frames(1000, 300, 6), {}, {}, {}));
  const std::size_t size = recorded_page(page.data).size();
  RecordProperty("bytes", static_cast<int>(size));
  EXPECT_LT(size, 30'000'000U);
  EXPECT_EQ(page.header["frames"]["count"], 300);
}

TEST(PackRun, ThinsWhatDoesNotFitAndSaysSo) {
  const Reader page(
      pack_run(make_run(100), make_frames(100, 600, 4), {}, {.page_bytes = 2'500'000}, {}));
  const auto count = page.header["frames"]["count"].get<std::size_t>();
  EXPECT_LT(count, 600U);
  EXPECT_GT(count, 50U);
  EXPECT_EQ(page.array<double>("frames.time").back(), 599.0 / 60.0);
  const auto offset = page.array<std::uint32_t>("contacts.offset");
  EXPECT_EQ(offset.size(), count + 1);
  EXPECT_LT(offset[1], 400U);
  const std::string notes = page.header["notes"].dump();
  EXPECT_THAT(notes, testing::HasSubstr("of 600 recorded frames are kept"));
  EXPECT_THAT(notes, testing::HasSubstr("contacts of a frame are kept"));
}

TEST(PackRun, ThinnedCurvesKeepTheirPeaks) {
  std::vector<model::StepReport> steps(1000);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i].time = static_cast<double>(i);
    steps[i].max_overlap = i == 333 ? 7.0 : 1.0;
    steps[i].energy.kinetic = static_cast<double>(i);
  }
  const Reader page(pack_run(make_run(1), make_frames(1, 2, 0), steps, {.curve_points = 100}, {}));
  const auto overlap = page.array<float>("steps.overlap_max");
  ASSERT_EQ(overlap.size(), 100U);
  EXPECT_EQ(*std::ranges::max_element(overlap), 7000.0F);
  EXPECT_EQ(page.array<double>("steps.time").back(), 999.0);
  EXPECT_EQ(page.array<float>("steps.kinetic").back(), 999.0F);
}

TEST(PackRun, MarksBodiesThatAreAbsent) {
  FrameSource frames = make_frames(2, 2, 1);
  frames.read = [inner = frames.read](std::size_t f) {
    FrameView frame = inner(f);
    if (f == 0) frame.x_W[1].setConstant(std::nan(""));
    return frame;
  };
  const Reader page(pack_run(make_run(2), frames, {}, {}, {}));
  const auto loads = page.array<std::uint16_t>("frames.load");
  EXPECT_EQ(loads[1], 0x7e00);
  EXPECT_LT(loads[3], 0x7c00);
}

TEST(PackRun, ARunWithoutFramesOrBodiesIsStillAPage) {
  const RunView empty;
  EXPECT_NO_THROW(pack_run(empty, {}, {}, {}, {}));
  EXPECT_NO_THROW(pack_run(make_run(3), {}, {}, {}, {}));
}

TEST(Page, HoldsTheRunOnceAndNoPlaceholder) {
  if (page_template().empty()) GTEST_SKIP() << "built without the viewer";
  const std::string page = recorded_page(pack_run(make_run(1), make_frames(1, 2, 0), {}, {}, {}));
  EXPECT_EQ(page.find("@GOTAI_RUN@"), std::string::npos);
  EXPECT_NE(page.find("data-source=\"file\">eJ"), std::string::npos);  // zlib's first bytes
  EXPECT_NE(live_page().find("data-source=\"live\"></script>"), std::string::npos);
}

TEST(ApparentContacts, AreTheCentresOfTheImpulsesOfEachPair) {
  ContactsView contacts;
  const auto add = [&](std::uint32_t a, std::uint32_t b, const Vec3& point, const Vec3& impulse) {
    contacts.body.insert(contacts.body.end(), {a, b});
    contacts.point_W.push_back(point);
    contacts.normal_W.push_back(Vec3::UnitZ());
    contacts.impulse_W.push_back(impulse);
    contacts.gap.push_back(-0.1);
  };
  add(0, 2, {0.0, 0.0, 0.0}, {0.5, 0.0, 1.0});  // friction does not weigh
  add(0, 2, {1.0, 0.0, 0.0}, {0.0, 0.0, 3.0});
  add(0, 2, {9.0, 9.0, 9.0}, Vec3::Zero());
  add(1, 2, {5.0, 0.0, 0.0}, Vec3::Zero());  // touches without an impulse
  const ContactsView apparent = apparent_contacts(contacts);
  ASSERT_EQ(apparent.size(), 1U);
  EXPECT_EQ(apparent.body, (std::vector<std::uint32_t>{0, 2}));
  EXPECT_TRUE(apparent.point_W[0].isApprox(Vec3(0.75, 0.0, 0.0)));
  EXPECT_TRUE(apparent.normal_W[0].isApprox(Vec3::UnitZ()));
  EXPECT_TRUE(apparent.impulse_W[0].isApprox(Vec3(0.5, 0.0, 4.0)));
}

}  // namespace
}  // namespace gotai::view
