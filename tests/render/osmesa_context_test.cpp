#include "render/osmesa_context.hpp"
#include "tests/support/message_of.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <stdexcept>
#include <thread>

namespace troupe::render::osmesa_context_test {
namespace {

using ::testing::HasSubstr;

TEST(OsmesaContext, SaysWhatToInstallWhenThereIsNone) {
  const std::array names = {"libOSMesa-that-is-nowhere.so.1", "libOSMesa-nor-here.so"};
  const std::string error = test::message_of<std::runtime_error>([&] { open_osmesa(names); });
  EXPECT_THAT(error,
              HasSubstr("cannot draw: OSMesa is not installed (Debian, Ubuntu: apt install libosmesa6): "));
  EXPECT_THAT(error, HasSubstr("; maps as .svg or .pdf do not need OSMesa"));
  EXPECT_THAT(error, HasSubstr(names[0]));
  EXPECT_THAT(error, HasSubstr(names[1]));
}

TEST(OsmesaContext, TakesTheFirstThatOpens) {
  const std::array names = {"libOSMesa-that-is-nowhere.so.1", "libOSMesa.so.8"};
  EXPECT_NE(open_osmesa(names), nullptr);
}

TEST(OsmesaContext, IsCurrentWhereverItIsMadeSo) {
  OsmesaContext first;
  OsmesaContext second;
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

TEST(OsmesaContext, GivesEntryPointsAgainAndAgain) {
  for (int i = 0; i < 3; ++i) {
    const OsmesaContext context;
    EXPECT_NE(context.procedure("glDrawArraysInstanced"), nullptr);
  }
}

}  // namespace
}  // namespace troupe::render::osmesa_context_test
