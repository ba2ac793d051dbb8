#include "gotai/view/live_server.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <ctime>
#include <nlohmann/json.hpp>
#include <thread>

#include "gotai/core/error.h"
#include "gotai/core/parallel.h"
#include "gotai/geometry/generate.h"
#include "gotai/view/live_frames.h"
#include "gotai/view/page.h"

namespace gotai::view {
namespace {

std::unique_ptr<World> falling_cube() {
  model::Settings settings;
  settings.collision.model = model::CollisionModel::spheres;
  settings.collision.level = 3;
  settings.time.step = 0.01;
  auto world = std::make_unique<World>(settings);
  world->add_shape(std::make_shared<const voxel::Shape>(voxel::make_shape(
      "cube", geometry::generate({}), {.prepared_level = 3, .surface_level = 0})));
  BodyDescription body;
  body.X_WM.p = Vec3(0.0, 0.0, 5.0);
  world->add_body(body);
  return world;
}

class Live : public testing::Test {
 protected:
  void SetUp() override {
    if (page_template().empty()) GTEST_SKIP() << "built without the viewer";
    world = falling_cube();
    server = std::make_unique<LiveServer>(*world, "cube", "test", LiveServer::Options{});
  }
  httplib::Client client() const {
    httplib::Client out("127.0.0.1", server->port());
    out.set_read_timeout(20);
    return out;
  }
  /// Steps until told to stop, as `gotai run --live` does.
  void run(int steps) {
    for (int i = 0; i < steps && !stop; ++i) {
      server->wait_while_paused([this] { return stop.load(); });
      server->on_step(*world, world->step());
      ++done;
    }
  }

  std::unique_ptr<World> world;
  std::unique_ptr<LiveServer> server;
  std::atomic<bool> stop{false};
  std::atomic<int> done{0};
};

TEST_F(Live, ServesItsPageAndTheScene) {
  auto http = client();
  const auto page = http.Get("/", {{"Accept-Encoding", "br, gzip"}});
  ASSERT_TRUE(page);
  EXPECT_EQ(page->status, 200);
  // Compressing it takes longer than a loopback saves: 1.4 s against 10 ms.
  EXPECT_FALSE(page->has_header("Content-Encoding"));
  EXPECT_THAT(page->body, testing::HasSubstr("data-source=\"live\""));
  const auto scene = http.Get("/scene");
  ASSERT_TRUE(scene);
  EXPECT_EQ(scene->body.substr(0, 4), "GTV1");
  EXPECT_THAT(scene->body, testing::HasSubstr("\"live\":true"));
  EXPECT_EQ(http.Get("/elsewhere")->status, 404);
}

TEST_F(Live, RefusesOtherOriginsAndHosts) {
  auto http = client();
  const std::string own = "127.0.0.1:" + std::to_string(server->port());
  const auto status = [&](const httplib::Headers& headers) {
    return http.Get("/scene", headers)->status;
  };
  EXPECT_EQ(status({{"Origin", "http://" + own}}), 200);
  EXPECT_EQ(status({{"Origin", "http://example.org"}}), 403);
  EXPECT_EQ(status({{"Origin", "https://" + own}}), 403);
  EXPECT_EQ(status({{"Origin", "null"}}), 403);
  EXPECT_EQ(status({{"Origin", "http://127.0.0.1:1"}}), 403);
  EXPECT_EQ(status({{"Sec-Fetch-Site", "cross-site"}}), 403);
  EXPECT_EQ(status({{"Sec-Fetch-Site", "same-site"}}), 403);
  EXPECT_EQ(status({{"Sec-Fetch-Site", "same-origin"}}), 200);
  EXPECT_EQ(http.Post("/pause", {{"Origin", "http://example.org"}}, "", "text/plain")->status, 403);
  // A foreign name that leads to this machine.
  EXPECT_EQ(status({{"Host", "example.org"}}), 403);
}

TEST_F(Live, SendsFramesAsTheyComeAndThenTheEnd) {
  std::string received;
  std::atomic<bool> connected{false};
  std::thread viewer([&] {
    auto http = client();
    http.Get("/events", [&](const char* data, std::size_t size) {
      received.append(data, size);
      connected = true;
      return true;
    });
  });
  while (!connected) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  run(50);
  server->finish(10.0);
  viewer.join();
  std::size_t frames = 0;
  for (std::size_t at = 0; (at = received.find("event: frame\n", at)) != std::string::npos; ++at)
    ++frames;
  EXPECT_GE(frames, 29U);  // half a second, 60 per second, steps of 10 ms
  EXPECT_LE(frames, 51U);
  EXPECT_THAT(received, testing::EndsWith("event: end\ndata: end\n\n"));
}

TEST_F(Live, GoesOnWhereAPageLostItsConnection) {
  run(50);
  std::string received;
  std::thread viewer([&] {
    client().Get("/events?from=20", [&](const char* data, std::size_t size) {
      received.append(data, size);
      return true;
    });
  });
  server->wait_for_viewer(10.0, [] { return false; });
  server->finish(10.0);
  viewer.join();
  EXPECT_THAT(received, testing::StartsWith("id: 20\nevent: frame\n"));
}

TEST_F(Live, WaitsForTheFirstPageAsLongAsItIsTold) {
  EXPECT_FALSE(server->wait_for_viewer(0.05, [] { return false; }));
  EXPECT_FALSE(server->wait_for_viewer(100.0, [] { return true; }));
  std::thread viewer([&] { client().Get("/events"); });
  EXPECT_TRUE(server->wait_for_viewer(100.0, [] { return false; }));
  server->finish(10.0);
  viewer.join();
}

TEST_F(Live, SmallStepsAreFewPointsOfTheCurves) {
  model::StepReport report;
  for (int i = 0; i < 1000; ++i) {
    report.time = 1e-5 * (i + 1);
    report.max_overlap = i == 500 ? 0.25 : 0.0;
    server->on_step(*world, report);  // the world itself stands still: no frame is due
  }
  server->on_step(*world, world->step());
  server->on_step(*world, world->step());  // the first frame
  std::string received;
  std::thread viewer([&] {
    client().Get("/events", [&](const char* data, std::size_t size) {
      received.append(data, size);
      return true;
    });
  });
  server->wait_for_viewer(10.0, [] { return false; });
  server->finish(10.0);
  viewer.join();
  EXPECT_LT(received.size(), 20'000U);
}

/// Processor time of this thread [s]: what other programs do does not count.
double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

TEST_F(Live, SlowsTheRunByLessThanATwentieth) {
  // 20 hexapods on the ground, touching, as chapter 5 runs them.
  const ThreadLimit one(1);
  model::Settings settings;
  settings.collision.level = 4;
  settings.collision.model = model::CollisionModel::spheres;
  settings.impulse.contacts = model::ContactTreatment::apparent;
  settings.time.step = 0.01;
  World pile(settings);
  pile.add_shape(std::make_shared<const voxel::Shape>(
      voxel::make_shape("block", geometry::generate({.shape = "hexapod", .size = 1.0}),
                        {.prepared_level = 4, .surface_level = 0})));
  pile.add_plane({});
  for (int i = 0; i < 20; ++i) {
    BodyDescription body;
    const int row = i / 4 % 2;
    const int layer = i / 8;
    body.X_WM.p = Vec3(0.9 * (i % 4), 0.9 * row, 0.6 + 0.9 * layer);
    pile.add_body(body);
  }
  LiveServer live(pile, "pile", "test", {.free_seconds = 0.0});
  std::size_t received = 0;
  std::thread viewer([&] {
    httplib::Client http("127.0.0.1", live.port());
    http.Get("/events", [&](const char*, std::size_t size) {
      received += size;
      return true;
    });
  });
  live.wait_for_viewer(10.0, [] { return false; });
  double stepping = 0.0;
  double showing = 0.0;
  for (int i = 0; i < 300; ++i) {
    const double begin = thread_seconds();
    live.wait_while_paused([] { return false; });
    const double free = thread_seconds();
    const model::StepReport report = pile.step();
    const double stepped = thread_seconds();
    live.on_step(pile, report);
    const double shown = thread_seconds();
    const double asking = 2.0 * (thread_seconds() - shown);  // what the clock itself takes
    showing += shown - stepped + free - begin - asking;
    stepping += stepped - free;
  }
  live.finish(10.0);
  viewer.join();
  EXPECT_GT(received, 50'000U);
  RecordProperty("percent", std::to_string(100.0 * showing / stepping));
  EXPECT_LT(showing, 0.05 * stepping);
}

TEST_F(Live, PausesStepsAndResumes) {
  auto http = client();
  ASSERT_EQ(http.Post("/pause")->status, 204);
  std::thread simulation([this] { run(1000000); });
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(done, 0);
  for (int expected = 1; expected <= 2; ++expected) {
    http.Post("/step");
    for (int i = 0; i < 500 && done < expected; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_EQ(done, expected);
  }
  http.Post("/resume");
  for (int i = 0; i < 500 && done < 5; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_GE(done, 5);
  http.Post("/pause");
  stop = true;  // ends a paused run, too
  simulation.join();
}

TEST_F(Live, EndsAtOnceWhenAViewerStaysAway) {
  auto http = client();
  http.Get("/");
  const auto begin = std::chrono::steady_clock::now();
  server.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
}

TEST_F(Live, APortThatIsTakenIsAnError) {
  EXPECT_THROW(LiveServer(*world, "cube", "test", {.port = server->port()}), Error);
}

TEST(LiveFramesQueue, ForgetsFramesThatTakeTooMuchMemory) {
  LiveFrames frames;
  for (int i = 0; i < 40; ++i) {
    LiveFrame frame;
    frame.frame.contacts.gap.resize(200'000);  // 88 bytes with what belongs to it
    frames.push(std::move(frame));
  }
  bool closed = false;
  const auto first = frames.next(0, std::chrono::milliseconds(0), closed);
  ASSERT_TRUE(first);
  EXPECT_GT(first->number, 20U);
  EXPECT_LT(first->number, 30U);
}

TEST(CurvePoints, KeepThePeaksAndTheLastEnergies) {
  std::vector<model::StepReport> steps(10);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i].time = static_cast<double>(i);
    steps[i].max_overlap = i == 3 ? 7.0 : 1.0;
    steps[i].energy.kinetic = static_cast<double>(i);
  }
  const auto points = curve_points(steps, 2);
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[0].time, 4.0);
  EXPECT_EQ(points[1].time, 9.0);
  for (std::size_t c = 0; c < curves().size(); ++c) {
    if (curves()[c].name == "overlap_max") {
      EXPECT_GT(points[0].values[c], points[1].values[c]);
    }
    if (curves()[c].name == "kinetic") {
      EXPECT_EQ(points[1].values[c], 9.0);
    }
  }
  EXPECT_TRUE(curve_points({}, 2).empty());
}

TEST(LiveFramesQueue, KeepsTheNewestAndTellsWhenItIsClosed) {
  LiveFrames frames;
  for (int i = 0; i < 2500; ++i) {
    LiveFrame frame;
    frame.frame.time = i;
    frames.push(std::move(frame));
  }
  bool closed = true;
  const auto first = frames.next(0, std::chrono::milliseconds(0), closed);
  ASSERT_TRUE(first);
  EXPECT_FALSE(closed);
  EXPECT_EQ(first->number, 700U);
  EXPECT_EQ(first->frame->frame.time, 700.0);
  EXPECT_FALSE(frames.next(2500, std::chrono::milliseconds(1), closed));
  frames.close();
  EXPECT_FALSE(frames.next(2500, std::chrono::seconds(100), closed));
  EXPECT_TRUE(closed);
}

}  // namespace
}  // namespace gotai::view
