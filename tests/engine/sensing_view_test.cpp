#include "engine/sensing/sensing_view.hpp"

#include "tests/support/message_of.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace troupe::engine::sensing_view_test {
namespace {

TEST(SensingView, TheRowOfABodyIsHereOrElsewhereOrThereIsNone) {
  WorldSpec spec;
  spec.bodies.resize(3);
  spec.bodies[2].name = spec.names.add("far");
  const std::vector<Row> rows{Row(), Row(0), k_elsewhere};
  PublicColumns columns;
  columns.spec = &spec;
  columns.rows = rows;
  const SensingView view(columns);
  EXPECT_EQ(view.location(BodyId(0)), RowLocation::none);
  EXPECT_EQ(view.location(BodyId(1)), RowLocation::here);
  EXPECT_EQ(view.location(BodyId(2)), RowLocation::elsewhere);
  EXPECT_FALSE(view.row(BodyId(0)).valid());
  EXPECT_EQ(view.row(BodyId(1)), Row(0));
  EXPECT_EQ(test::message_of<std::logic_error>([&] { static_cast<void>(view.row(BodyId(2))); }),
            "internal error: the data of \"far\" was read on a rank that does not have it. If a plug-in "
            "read it, the plug-in has an error: it may read only bodies that its device can reach. "
            "Otherwise your input is not the cause: please report this");
}

}  // namespace
}  // namespace troupe::engine::sensing_view_test
