#include "render/theme.hpp"

#include <array>
#include <cstddef>

namespace troupe::render {
namespace {

// The themes in the order of Background. With `transparent`, shadows and grid lines are black and mostly
// transparent, so that they darken the page on which the picture lies.
constexpr std::array<Theme, 4> k_themes = {{
    {.ground = {250, 247, 240, 255},
     .shadow = {226, 220, 207, 255},
     .grid = {233, 227, 214, 255},
     .ink = {92, 86, 75, 255},
     .halo = {250, 247, 240, 230},
     .line = {60, 56, 50, 220},
     .square = {120, 112, 98, 150}},
    {.ground = {255, 255, 255, 255},
     .shadow = {226, 226, 226, 255},
     .grid = {232, 232, 232, 255},
     .ink = {60, 60, 60, 255},
     .halo = {255, 255, 255, 230},
     .line = {60, 60, 60, 220},
     .square = {110, 110, 110, 150}},
    {.ground = {27, 29, 34, 255},
     .shadow = {14, 15, 18, 255},
     .grid = {45, 48, 55, 255},
     .ink = {216, 213, 205, 255},
     .halo = {27, 29, 34, 230},
     .line = {170, 168, 160, 220},
     .square = {140, 138, 130, 150}},
    {.ground = {0, 0, 0, 0},
     .shadow = {0, 0, 0, 28},
     .grid = {0, 0, 0, 22},
     .ink = {60, 60, 60, 255},
     .halo = {255, 255, 255, 200},
     .line = {60, 60, 60, 220},
     .square = {110, 110, 110, 150}},
}};

}  // namespace

const Theme& theme_of(Background background) { return k_themes[static_cast<std::size_t>(background)]; }

}  // namespace troupe::render
