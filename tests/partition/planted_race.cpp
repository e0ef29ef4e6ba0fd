// A loop whose tasks write what others read. Under the thread sanitizer it must be reported
// (tests/CMakeLists.txt): a sanitizer that cannot see through the loop would pass every test.
#include "partition/parallel.hpp"

#include <cstdio>

int main() {
  troupe::partition::Parallel parallel(4);
  int sum = 0;
  for (int loop = 0; loop < 100; ++loop)
    parallel.for_each(64, [&](std::size_t i) { sum += static_cast<int>(i); });
  std::printf("%d\n", sum);
}
