#include "render/offscreen_context.hpp"
#include "tests/support/message_of.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

namespace troupe::render::offscreen_context_test {
namespace {

using ::testing::HasSubstr;

using Open = std::shared_ptr<const OffscreenLibrary> (*)(std::span<const char* const> names,
                                                         std::string& reasons);

TEST(OffscreenLibraries, AreNullWhenThereIsNone) {
  const std::array names = {"libOSMesa-that-is-nowhere.so.1", "libOSMesa-nor-here.so"};
  std::string reasons;
  EXPECT_EQ(open_osmesa(names, reasons), nullptr);
  const std::array others = {"libEGL-that-is-nowhere.so.1"};
  EXPECT_EQ(open_egl(others, reasons), nullptr);
  for (const char* name : {names[0], names[1], others[0]}) EXPECT_THAT(reasons, HasSubstr(name));
}

TEST(OffscreenLibraries, AreTheFirstThatOpens) {
  const std::array names = {"libOSMesa-that-is-nowhere.so.1", "libOSMesa.so.8"};
  std::string reasons;
  EXPECT_NE(open_osmesa(names, reasons), nullptr);
  EXPECT_EQ(reasons, "");
}

TEST(OffscreenLibraries, OfAnotherKindAreTooOld) {
  const std::array names = {"libEGL.so.1"};
  std::string reasons;
  EXPECT_THAT(test::message_of<std::runtime_error>([&] { open_osmesa(names, reasons); }),
              HasSubstr("has no function OSMesaCreateContextAttribs"));
}

struct Library {
  const char* kind;
  Open open;
  const char* name;
};

/// Tests with each library, of which Debian 12 has both.
class OffscreenContexts : public ::testing::TestWithParam<Library> {
 protected:
  void SetUp() override {
    const std::array names{GetParam().name};
    std::string reasons;
    library_ = GetParam().open(names, reasons);
    if (!library_) GTEST_SKIP() << reasons;
  }

  std::shared_ptr<const OffscreenLibrary> library_;
};
INSTANTIATE_TEST_SUITE_P(Of, OffscreenContexts,
                         ::testing::Values(Library{"osmesa", open_osmesa, "libOSMesa.so.8"},
                                           Library{"egl", open_egl, "libEGL.so.1"}),
                         [](const auto& library) { return library.param.kind; });

TEST_P(OffscreenContexts, AreCurrentWhereverTheyAreMadeSo) {
  OffscreenContext first(library_);
  OffscreenContext second(library_);
  for (int i = 0; i < 2; ++i) {
    first.make_current();
    second.make_current();
    second.release();
  }
  std::thread([&] {
    first.make_current();
    first.release();
  }).join();
}

TEST_P(OffscreenContexts, GiveEntryPointsAgainAndAgain) {
  for (int i = 0; i < 3; ++i) {
    const OffscreenContext context(library_);
    EXPECT_NE(context.procedure("glDrawArraysInstanced"), nullptr);
  }
}

TEST_P(OffscreenContexts, DrawOnTheProcessor) {
  constexpr unsigned k_renderer = 0x1f01;
  OffscreenContext context(library_);
  context.make_current();
  const auto get_string = reinterpret_cast<const char* (*)(unsigned)>(context.procedure("glGetString"));
  EXPECT_THAT(get_string(k_renderer), HasSubstr("llvmpipe"));
  context.release();
}

}  // namespace
}  // namespace troupe::render::offscreen_context_test
