#include "partition/ray_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <mutex>
#include <stdexcept>
#include <utility>

namespace troupe::partition {
namespace {

constexpr unsigned k_region_bits = 6;  // 64 cells per edge
constexpr std::int32_t k_region = 1 << k_region_bits;
constexpr std::int32_t k_block = 8;
constexpr std::int32_t k_square = 32;       // cells per edge of a square, a quarter of a region
constexpr std::uint32_t k_link = 1u << 31;  // set in a mark that is the number of a Link
constexpr std::uint32_t k_unmarked = ~0u;
constexpr std::uint32_t k_share = 128;        // outlines per drawing task
constexpr std::size_t k_batch = 8;            // regions per assembling task
constexpr std::int64_t k_farthest = 1 << 29;  // cells from the origin; twice this number fits in 32 bits

std::uint32_t take(std::uint32_t& counter, std::uint32_t n) {
  return std::atomic_ref(counter).fetch_add(n, std::memory_order_relaxed);
}

/// The number of set bits. std::popcount would be a function call: the compiler may not use the instruction
/// for it, because not every x86-64 processor has that instruction.
std::uint32_t count(std::uint64_t word) {
  word -= word >> 1 & 0x5555555555555555;
  word = (word & 0x3333333333333333) + (word >> 2 & 0x3333333333333333);
  return static_cast<std::uint32_t>(((word + (word >> 4)) & 0x0F0F0F0F0F0F0F0F) * 0x0101010101010101 >> 56);
}

/// The number of set bits among the bits 0 to bit - 1 of the word.
std::uint32_t rank(std::uint64_t word, std::uint32_t bit) {
  return count(word & ((std::uint64_t{1} << bit) - 1));
}

template <class Visit>
void for_each_bit(std::uint64_t word, Visit&& visit) {
  for (; word != 0; word &= word - 1) visit(static_cast<std::uint32_t>(std::countr_zero(word)));
}

/// The largest number of cells that an edge of this length can draw, at any angle.
double most_cells(const Vec2& a, const Vec2& b, double resolution) {
  return 1.41422 * (b - a).norm() / resolution + 3;
}

std::string too_fine(double resolution, double bytes, double most_bytes) {
  // Only outlines are drawn, so cells of twice the size take half the memory. The suggestion adds 10 %.
  return fmt::format(
      "cells of {:g} m would take {:.3g} GB, more than the limit of {:.3g} GB; set the resolution to {:.2g} "
      "m or more",
      resolution, bytes / 1e9, most_bytes / 1e9, 1.1 * resolution * bytes / most_bytes);
}

}  // namespace

/// Draws outlines into a Drawing. Stores the cells from index `cell` of Drawing::cells on, and the runs
/// (consecutive cells of one outline in one region) from index `run` of Drawing::runs on. Calls file(region,
/// index of the run) whenever a run is complete.
class RayGrid::Rasterizer {
 public:
  Rasterizer(const GridGeometry& geometry, Drawing& drawing, std::uint32_t cell, std::uint32_t run)
      : geometry_(geometry), drawing_(drawing), cell_(cell), run_(run) {}

  template <class File>
  void draw(std::span<const Vec2> ring, std::uint32_t surface, File&& file) {
    begin_ = cell_;
    surface_ = surface;
    const std::uint32_t first = cell_;
    Cell at = geometry_.cell(ring.back());
    region_ = geometry_.tile(at);
    for (const Vec2& vertex : ring) {
      const Cell to = geometry_.cell(vertex);
      draw_line(at, to, file);
      at = to;
    }
    if (cell_ == first) add_cell(at, file);
    close(file);
  }

 private:
  template <class File>
  void draw_line(Cell at, Cell to, File& file) {
    const std::int32_t step_x = to.x > at.x ? 1 : -1;
    const std::int32_t step_y = to.y > at.y ? 1 : -1;
    const std::int64_t across = std::abs(std::int64_t{to.x} - at.x);
    const std::int64_t up = std::abs(std::int64_t{to.y} - at.y);
    std::int64_t error = up - across;
    for (std::int64_t n = across + up; n > 0; --n) {
      add_cell(at, file);
      if (error < 0) {
        at.x += step_x;
        error += 2 * up;
      } else {
        at.y += step_y;
        error -= 2 * across;
      }
    }
  }

  template <class File>
  void add_cell(Cell at, File& file) {
    if (const Cell region = geometry_.tile(at); region != region_) {
      close(file);
      region_ = region;
    }
    drawing_.cells[cell_++] =
        static_cast<std::uint16_t>((at.y & 0x38) << 6 | (at.x & 0x38) << 3 | (at.y & 7) << 3 | (at.x & 7));
  }

  template <class File>
  void close(File& file) {
    if (cell_ == begin_) return;
    drawing_.runs[run_] = {k_none, begin_, cell_ - begin_, surface_};
    file(region_, run_++);
    begin_ = cell_;
  }

  const GridGeometry& geometry_;
  Drawing& drawing_;
  std::uint32_t cell_;
  std::uint32_t run_;
  std::uint32_t begin_ = 0;  // first cell of the current run
  std::uint32_t surface_ = 0;
  Cell region_;
};

/// A ray and how far it has been followed. Positions are in cells. In squares in which anything is drawn, the
/// ray takes steps from cell to cell: a step along x crosses a border between two columns of cells, and a
/// step along y a border between two rows. i and j count the steps along x and y. The ray jumps over empty
/// squares.
///
/// `across` and `up` are the extents of the ray along x and y over its whole range, in whole cells. They
/// define the order of the steps: step i along x has the parameter (2 i - 1) / across, step j along y has the
/// parameter (2 j - 1) / up, and the step with the smaller parameter comes first. Jumps do not change this
/// order.
class RayGrid::Line {
 public:
  class Jumps;

  Line(const GridRay& ray, double cell_m)
      : step_x(ray.direction.x() < 0 ? -1 : 1),
        step_y(ray.direction.y() < 0 ? -1 : 1),
        across(extent(ray.direction.x(), ray, cell_m)),
        up(extent(ray.direction.y(), ray, cell_m)),
        last(across + up),
        start_(ray.origin / cell_m),
        base_(start_),
        sign_(step_x, step_y),
        forward_(ray.direction.cwiseAbs()),
        cell_m_(cell_m) {}

  /// False if the ray starts k_farthest cells or more from the world's origin along x or y, outside the grid.
  bool starts_on_grid() const { return start_.cwiseAbs().maxCoeff() < static_cast<double>(k_farthest); }
  /// The position, in cells, after to_i steps along x and to_j steps along y, counted from the start of the
  /// ray. There must be no jump between the present position and that one.
  Vec2 after(std::int64_t to_i, std::int64_t to_j) const {
    return {base_.x() + sign_.x() * static_cast<double>(to_i - base_i_),
            base_.y() + sign_.y() * static_cast<double>(to_j - base_j_)};
  }
  /// The cell of a position, which is rounded towards zero.
  static Cell cell_of(const Vec2& at) {
    return {static_cast<std::int32_t>(at.x()), static_cast<std::int32_t>(at.y())};
  }
  /// Whether the cells of later positions can be found by counting steps from the cell of the position `at`,
  /// without rounding each position. This is not so if a coordinate is between -1 and 0 and increases.
  /// Rounding towards zero gives cell 0 for all coordinates between -1 and 1. From -0.5, for example, a step
  /// leads to 0.5, which is still in cell 0, but counting steps gives cell 1.
  bool keeps_pace(const Vec2& at) const {
    return (step_x < 0 || at.x() >= 0 || at.x() <= -1) && (step_y < 0 || at.y() >= 0 || at.y() <= -1);
  }

  /// Negative if the ray takes its x-th step along x before its y-th step along y. Steps count from 1.
  std::int64_t order(std::int64_t x, std::int64_t y) const { return up * (2 * x - 1) - across * (2 * y - 1); }
  /// y_steps: the number of steps along y before the x-th step along x. x_steps: the number of steps along x
  /// before the y-th step along y. Of two steps at the same point, the step along y comes first.
  std::int64_t y_steps(std::int64_t x) const { return (up * (2 * x - 1) + across) / (2 * across); }
  std::int64_t x_steps(std::int64_t y) const { return (across * (2 * y - 1) + up - 1) / (2 * up); }

  /// The number of steps along x, or along y, by which the ray leaves the block that contains this cell.
  std::int64_t x_to_border(std::int32_t x) const { return step_x > 0 ? k_block - (x & 7) : (x & 7) + 1; }
  std::int64_t y_to_border(std::int32_t y) const { return step_y > 0 ? k_block - (y & 7) : (y & 7) + 1; }

  /// Ends a series of jumps at the position `at`. left: largest number of steps that may follow
  void land(const Vec2& at, std::int64_t left) {
    base_ = at;
    base_i_ = i;
    base_j_ = j;
    last = i + j + left;
  }
  /// The range after to_i steps along x and to_j steps along y, m: the distance moved along the axis with the
  /// larger extent, divided by the component of the direction along this axis.
  float range(std::int64_t to_i, std::int64_t to_j) const {
    const Vec2 moved = (after(to_i, to_j) - start_).cwiseAbs();
    return static_cast<float>((across > up ? moved.x() / forward_.x() : moved.y() / forward_.y()) * cell_m_);
  }

  const std::int32_t step_x, step_y;
  const std::int64_t across, up;
  std::int64_t i = 0;
  std::int64_t j = 0;
  std::int64_t last;  // the number of steps, i + j, after which the ray ends

 private:
  /// The extent of the ray along an axis, in whole cells. component: the ray's direction along this axis. The
  /// limit k_farthest keeps order() below 2^62: a ray takes at most 2^30 steps.
  static std::int64_t extent(double component, const GridRay& ray, double cell_m) {
    return static_cast<std::int64_t>(
        std::abs(component) *
        std::min(static_cast<double>(ray.range_max) / cell_m, static_cast<double>(k_farthest)));
  }

  Vec2 start_;
  Vec2 base_;  // the position after the last jump, and the steps that had been taken before it
  std::int64_t base_i_ = 0;
  std::int64_t base_j_ = 0;
  Vec2 sign_;     // step_x and step_y
  Vec2 forward_;  // magnitudes of the direction's components
  double cell_m_;
};

/// A series of jumps of a ray over empty squares. All jumps are along one straight line from the position
/// where the series begins. Each jump ends at the next border of a square: at the border itself if the
/// coordinate increases, and one cell beyond the border if the coordinate decreases.
class RayGrid::Line::Jumps {
 public:
  /// from: the position where the jumps begin, in cells; cell: the cell of this position
  Jumps(const Line& line, const Vec2& from, Cell cell)
      : from_x_(from.x()),
        from_y_(from.y()),
        sign_x_(line.sign_.x()),
        sign_y_(line.sign_.y()),
        forward_x_(line.forward_.x()),
        forward_y_(line.forward_.y()),
        per_x_(1 / forward_x_),
        per_y_(1 / forward_y_),
        border_x_(line.step_x > 0 ? (cell.x | (k_square - 1)) + 1 : (cell.x & -k_square) - 1),
        border_y_(line.step_y > 0 ? (cell.y | (k_square - 1)) + 1 : (cell.y & -k_square) - 1) {}

  /// Makes the next jump and returns the number of steps that this jump replaces. The code has no branch,
  /// because it is unpredictable which border is nearer.
  double next() {
    const double to_x = std::abs(border_x_ - from_x_);
    const double to_y = std::abs(border_y_ - from_y_);
    const double along_x = to_x * per_x_;  // cells along the ray; infinite if the ray runs along y
    const double along_y = to_y * per_y_;
    const double nearest = std::min(along_x, along_y);
    // The minima keep rounding from carrying the ray past the other border.
    const double moved_x = from_x_ + sign_x_ * std::min(nearest * forward_x_, to_x);
    const double moved_y = from_y_ + sign_y_ * std::min(nearest * forward_y_, to_y);
    at_.x() = along_x < along_y ? border_x_ : moved_x;
    at_.y() = along_x < along_y ? moved_y : border_y_;
    border_x_ += along_x < along_y ? k_square * sign_x_ : 0;
    border_y_ += along_x < along_y ? 0 : k_square * sign_y_;
    const double steps = (nearest - before_) * (forward_x_ + forward_y_);
    before_ = nearest;
    return steps;
  }
  const Vec2& at() const { return at_; }  ///< the position after the last jump

 private:
  const double from_x_, from_y_;
  const double sign_x_, sign_y_;
  const double forward_x_, forward_y_;
  const double per_x_, per_y_;  // cells along the ray per cell along x or y; may be infinite
  double border_x_, border_y_;  // positions at which the next jumps end
  double before_ = 0;
  Vec2 at_;
};

RayGrid::RayGrid(std::span<const FixedSolid> solids, std::vector<MovingOutline> outlines,
                 std::span<const Vec2> vertices, double resolution_m)
    : cells_{resolution_m, k_region_bits}, outlines_(std::move(outlines)) {
  std::erase_if(outlines_, [](const MovingOutline& o) { return o.ranger_return < 0 || o.count == 0; });
  heights_.resize(outlines_.size());
  share_out(vertices);
  draw_fixed(solids);
}

/// Divides the outlines of the mobile bodies into shares_, and allocates memory for the largest numbers of
/// cells and runs that these outlines can draw.
void RayGrid::share_out(std::span<const Vec2> vertices) {
  double cells = 0;
  double runs = 0;
  for (std::uint32_t o = 0; o < outlines_.size(); ++o) {
    if (o % k_share == 0)
      shares_.push_back({o, static_cast<std::uint32_t>(cells), static_cast<std::uint32_t>(runs)});
    const std::span<const Vec2> ring = vertices.subspan(outlines_[o].first, outlines_[o].count);
    double most = 1;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
      most += most_cells(ring[j], ring[i], cells_.cell_m);
    cells += most;
    runs += std::min(most, most / k_region + 2 * static_cast<double>(ring.size()) + 1);
    const double bytes = cells * (sizeof(std::uint16_t) + sizeof(std::uint32_t)) + runs * sizeof(Run);
    if (bytes > static_cast<double>(k_most_bytes))
      throw std::length_error(too_fine(cells_.cell_m, bytes * static_cast<double>(outlines_.size()) / (o + 1),
                                       static_cast<double>(k_most_bytes)));
  }
  shares_.push_back({static_cast<std::uint32_t>(outlines_.size()), static_cast<std::uint32_t>(cells),
                     static_cast<std::uint32_t>(runs)});
  drawing_ = {std::unique_ptr<std::uint16_t[]>(new std::uint16_t[shares_.back().cell]),
              std::unique_ptr<Run[]>(new Run[shares_.back().run])};
}

void RayGrid::draw_fixed(std::span<const FixedSolid> solids) {
  const auto for_each_ring = [&](auto&& visit) {
    for (const FixedSolid& solid : solids)
      if (solid.ranger_return >= 0)
        for (const Ring& ring : solid.solid.contours)
          if (!ring.empty()) visit(solid, ring);
  };
  const double limit = static_cast<double>(k_farthest) * cells_.cell_m;
  double cells = 0;
  double runs = 0;
  for_each_ring([&](const FixedSolid&, const Ring& ring) {
    ++cells;
    ++runs;
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const double most = most_cells(ring[j], ring[i], cells_.cell_m);
      cells += most;
      runs += std::min(most, most / k_region + 2);
      if (const double away = ring[i].cwiseAbs().maxCoeff(); !(away <= limit)) {
        constexpr auto k_text =
            "with cells of {:g} m, the grid reaches {:.0f} m from the origin, but the static scene reaches "
            "{:.0f} m; set a resolution with larger cells";
        throw std::length_error(fmt::format(k_text, cells_.cell_m, limit, away));
      }
    }
  });
  const auto check = [&](std::size_t regions) {
    constexpr double k_cell_bytes = sizeof(std::uint16_t) + 2 * sizeof(std::uint32_t);
    constexpr double k_region_bytes = sizeof(Region) + sizeof(Slot);
    const double bytes =
        cells * k_cell_bytes + runs * sizeof(Run) + static_cast<double>(regions) * k_region_bytes;
    if (bytes <= static_cast<double>(k_most_bytes)) return;
    // Also estimates the regions that are not counted yet: a straight wall draws about 64 cells in each.
    const double with_regions = cells * (k_cell_bytes + k_region_bytes / k_region);
    throw std::length_error(
        too_fine(cells_.cell_m, std::max(bytes, with_regions), static_cast<double>(k_most_bytes)));
  };
  check(0);

  // Marks and links are needed for the fixed cells, for copies of them in live regions, and for each cell
  // that the bodies draw.
  const auto fixed = static_cast<std::size_t>(cells);
  marks_.reset(new std::uint32_t[2 * fixed + shares_.back().cell]);
  links_.reset(new Link[fixed + shares_.back().cell]);
  Drawing drawing{std::unique_ptr<std::uint16_t[]>(new std::uint16_t[fixed]),
                  std::unique_ptr<Run[]>(new Run[static_cast<std::size_t>(runs)])};
  Rasterizer rasterizer(cells_, drawing, 0, 0);
  std::map<Surface, std::uint32_t> known;
  for_each_ring([&](const FixedSolid& solid, const Ring& ring) {
    const Surface surface{solid.solid.z.min, solid.solid.z.max, solid.ranger_return};
    const auto [entry, is_new] = known.try_emplace(surface, static_cast<std::uint32_t>(surfaces_.size()));
    if (is_new) surfaces_.push_back(surface);
    rasterizer.draw(ring, entry->second, [&](Cell region, std::uint32_t run) {
      Slot& slot = slot_in(region);
      drawing.runs[run].next = slot.runs;
      slot.runs = run;
    });
  });
  fixed_regions_ = slots_.size();
  check(fixed_regions_);
  const Region nothing;
  for (Slot& slot : slots_) {
    slot.fixed = std::make_unique<Region>();
    assemble(*slot.fixed, nothing, drawing, slot);
    slot.redrawn = 0;
    slot.seen = slot.fixed.get();
  }
  fixed_marks_ = used_marks_;
  fixed_links_ = used_links_;

  for (std::uint32_t o = 0; o < outlines_.size(); ++o) {
    if (own_.size() <= outlines_[o].body) own_.resize(outlines_[o].body + 1);
    Own& own = own_[outlines_[o].body];
    if (own.count++ == 0) own.first = static_cast<std::uint32_t>(surfaces_.size()) + o;
  }
}

/// Returns the slot of a region; adds it if there is none.
RayGrid::Slot& RayGrid::slot_in(Cell region) {
  const std::uint32_t slot = directory_.insert(region);
  if (slot == slots_.size()) {
    slots_.emplace_back();
    low_ = {std::min(low_.x, region.x), std::min(low_.y, region.y)};
    high_ = {std::max(high_.x, region.x), std::max(high_.y, region.y)};
  }
  return slots_[slot];
}

void RayGrid::redraw(std::span<const Vec2> vertices, std::span<const Pose> poses, Parallel& parallel,
                     const Linked& linked) {
  groups_ = linked.groups;
  // Runs are added to a list per region. Their order depends on the threads, but no result depends on this
  // order.
  std::vector<NewRegionRun> new_region_runs;
  std::mutex new_region_mutex;
  const auto file = [this](Slot& slot, std::uint32_t run) {
    std::atomic_ref head(slot.runs);
    drawing_.runs[run].next = head.load(std::memory_order_relaxed);
    while (!head.compare_exchange_weak(drawing_.runs[run].next, run, std::memory_order_relaxed)) {
    }
  };
  parallel.for_each(shares_.size() - 1, [&](std::size_t s) {
    Rasterizer rasterizer(cells_, drawing_, shares_[s].cell, shares_[s].run);
    for (std::uint32_t o = shares_[s].outline; o < shares_[s + 1].outline; ++o) {
      const MovingOutline& outline = outlines_[o];
      if (!linked.absent.empty() && linked.absent[outline.body] != 0) continue;
      heights_[o] = poses[outline.body].z + (linked.lifts.empty() ? 0.0 : linked.lifts[o]);
      rasterizer.draw(vertices.subspan(outline.first, outline.count),
                      static_cast<std::uint32_t>(surfaces_.size()) + o, [&](Cell region, std::uint32_t run) {
                        const std::uint32_t slot = directory_.find(region);
                        if (slot != TileDirectory::k_none && slots_[slot].live)
                          file(slots_[slot], run);
                        else {
                          const std::scoped_lock lock(new_region_mutex);
                          new_region_runs.push_back({region, run});
                        }
                      });
    }
  });
  // Bodies rarely enter new regions, so one thread adds them.
  for (const NewRegionRun& run : new_region_runs) {
    Slot& slot = slot_in(run.region);
    if (!slot.live) {
      slot.live = slot.fixed ? std::make_unique<Region>(*slot.fixed) : std::make_unique<Region>();
      live_.push_back(static_cast<std::uint32_t>(&slot - slots_.data()));
    }
    file(slot, run.run);
  }

  static const Region k_nothing;
  used_marks_ = fixed_marks_;
  used_links_ = fixed_links_;
  std::atomic<std::size_t> used = 0;
  parallel.for_batches(live_.size(), k_batch, [&](std::size_t first, std::size_t end) {
    std::size_t busy = 0;
    for (std::size_t l = first; l < end; ++l) {
      Slot& slot = slots_[live_[l]];
      slot.seen = slot.fixed.get();
      if (slot.runs == k_none) continue;
      ++busy;
      assemble(*slot.live, slot.fixed ? *slot.fixed : k_nothing, drawing_, slot);
      slot.seen = slot.live.get();
    }
    used.fetch_add(busy, std::memory_order_relaxed);
  });
  forget_empty_regions(used.load());
}

/// Draws the slot's runs into a region, and empties the slot's list of runs. The region must equal `base`
/// except in the blocks that the previous call for this slot redrew (Slot::redrawn). These blocks are first
/// restored from `base`.
void RayGrid::assemble(Region& region, const Region& base, const Drawing& drawing, Slot& slot) {
  for_each_bit(slot.redrawn, [&](std::uint32_t b) {
    region.cells[b] = base.cells[b];
    region.marks[b] = base.marks[b];
    region.owners[b] = k_shared;
  });
  const auto for_each_run = [&](auto&& visit) {
    for (std::uint32_t r = slot.runs; r != k_none; r = drawing.runs[r].next) {
      const Run& run = drawing.runs[r];
      visit(std::span(drawing.cells.get() + run.first, run.count), run.surface);
    }
  };
  std::uint64_t redrawn = 0;
  for_each_run([&](std::span<const std::uint16_t> cells, std::uint32_t surface) {
    const std::uint32_t owner =
        surface < surfaces_.size() ? k_shared : outlines_[surface - surfaces_.size()].body;
    for (const std::uint32_t cell : cells) {
      const std::uint32_t block = cell >> 6;
      const bool is_new = (redrawn >> block & 1) == 0;
      if (is_new ? region.cells[block] == 0 : region.owners[block] == owner)
        region.owners[block] = owner;
      else
        region.owners[block] = k_shared;
      redrawn |= std::uint64_t{1} << block;
      region.cells[block] |= std::uint64_t{1} << (cell & 63);
    }
  });
  region.blocks = base.blocks | redrawn;
  slot.redrawn = redrawn;

  std::uint32_t drawn = 0;
  for_each_bit(redrawn, [&](std::uint32_t b) { drawn += count(region.cells[b]); });
  std::uint32_t next = take(used_marks_, drawn);
  std::fill_n(marks_.get() + next, drawn, k_unmarked);
  for_each_bit(redrawn, [&](std::uint32_t b) {
    std::uint32_t from = base.marks[b];
    for_each_bit(base.cells[b],
                 [&](std::uint32_t c) { marks_[next + rank(region.cells[b], c)] = marks_[from++]; });
    region.marks[b] = next;
    next += count(region.cells[b]);
  });
  for_each_run([&](std::span<const std::uint16_t> cells, std::uint32_t surface) {
    for (const std::uint32_t cell : cells)
      mark(marks_[region.marks[cell >> 6] + rank(region.cells[cell >> 6], cell & 63)], surface);
  });
  slot.runs = k_none;
}

void RayGrid::mark(std::uint32_t& mark, std::uint32_t surface) {
  if (mark == k_unmarked) {
    mark = surface;
  } else if (mark != surface) {
    const std::uint32_t link = take(used_links_, 1);
    links_[link] = {surface, mark};
    mark = link | k_link;
  }
}

/// Frees regions that bodies have left, once they far outnumber those in use.
void RayGrid::forget_empty_regions(std::size_t used) {
  if (slots_.size() <= 64 + 4 * (fixed_regions_ + used)) return;
  std::vector<Slot> slots = std::exchange(slots_, std::vector<Slot>());
  const TileDirectory directory = std::exchange(directory_, TileDirectory());
  live_.clear();
  for (std::uint32_t s = 0; s < slots.size(); ++s) {
    Slot& slot = slots[s];
    if (slot.seen == slot.fixed.get()) slot.live.reset();
    if (!slot.seen) continue;
    slot_in(directory.tile(s)) = std::move(slot);
    if (slots_.back().live) live_.push_back(static_cast<std::uint32_t>(slots_.size() - 1));
  }
}

float RayGrid::met(std::uint32_t mark, const GridRay& ray) const {
  const std::uint32_t own = ray.body < own_.size() ? own_[ray.body].first : 0;
  const std::uint32_t own_count = ray.body < own_.size() ? own_[ray.body].count : 0;
  const auto return_of = [&](std::uint32_t surface) {
    if (surface - own < own_count) return -1.0f;
    if (surface < surfaces_.size()) {
      const Surface& fixed = surfaces_[surface];
      return fixed.z_min <= ray.z && ray.z <= fixed.z_max ? fixed.ranger_return : -1.0f;
    }
    const std::size_t o = surface - surfaces_.size();
    const MovingOutline& outline = outlines_[o];
    if (!groups_.empty() && ray.body < groups_.size() && groups_[outline.body] == groups_[ray.body])
      return -1.0f;
    return outline.z.shifted(heights_[o]).contains(ray.z) ? outline.ranger_return : -1.0f;
  };
  float most = -1;
  for (; mark & k_link; mark = links_[mark & ~k_link].next)
    most = std::max(most, return_of(links_[mark & ~k_link].surface));
  return std::max(most, return_of(mark));
}

/// The position of a cell in its block, or of a block in its region: x and y from 0 to 7. It is moved without
/// branches: which border comes next is unpredictable, and a mispredicted branch costs more than a dozen
/// steps. The low four bits of `at` are x and the next four are y, so that one addition moves either. The
/// fourth bit of x or y is set when the position leaves the block or region.
struct RayGrid::CellPosition {
  CellPosition(std::int32_t x, std::int32_t y) : at(x | y << 4) {}
  bool inside() const { return (at & 0x88) == 0; }
  /// True if both blocks are in the same square: all bits but the lower two of x and of y are equal.
  bool same_square(CellPosition other) const { return ((at ^ other.at) & ~0x33) == 0; }
  std::uint32_t bit() const { return static_cast<std::uint32_t>((at & 7) | (at >> 1 & 0x38)); }
  /// The bits of all blocks of the block's square.
  std::uint64_t blocks_of_square() const { return std::uint64_t{0x0F0F0F0F} << (bit() & 0x24); }
  std::int32_t x() const { return at & 7; }
  std::int32_t y() const { return at >> 4 & 7; }
  /// Moves by step_x (1 or -1) if the bits of `along_x` are all ones, or by step_y if they are all zeros.
  void step(std::int32_t step_x, std::int32_t step_y, std::int64_t along_x) {
    at += 16 * step_y + ((step_x - 16 * step_y) & static_cast<std::int32_t>(along_x));
  }

  std::int32_t at;
};

GridHit RayGrid::cast(const GridRay& ray) const {
  GridHit hit{ray.range_max, 0};
  Line line(ray, cells_.cell_m);
  if (!line.starts_on_grid()) return hit;
  // Copies of members of `line` that do not change, because the compiler would read the members again after
  // each call of met_in_block().
  const std::int32_t step_x = line.step_x;
  const std::int32_t step_y = line.step_y;
  const std::int64_t back = 2 * k_block * line.across;
  const std::int64_t both = 2 * k_block * line.up + back;
  Cell here;
  const Region* region = nullptr;
  const auto look_up = [&](Cell at) {
    here = cells_.tile(at);
    const std::uint32_t slot = directory_.find(here);
    region = slot == TileDirectory::k_none ? nullptr : slots_[slot].seen;
  };
  const auto is_empty = [&](CellPosition block) {
    return !region || (region->blocks & block.blocks_of_square()) == 0;
  };
  look_up(Line::cell_of(line.after(0, 0)));
  while (line.i + line.j < line.last) {
    const Vec2 position = line.after(line.i, line.j);
    const Cell at = Line::cell_of(position);
    if (cells_.tile(at) != here) look_up(at);
    CellPosition block(at.x >> 3 & 7, at.y >> 3 & 7);
    if (is_empty(block)) {
      std::int64_t left = line.last - line.i - line.j;
      Line::Jumps jumps(line, position, at);
      do {
        // Nothing is drawn beyond the outermost regions.
        if (!region && ((step_x > 0 ? here.x > high_.x : here.x < low_.x) ||
                        (step_y > 0 ? here.y > high_.y : here.y < low_.y)))
          return hit;
        // A jump counts as the steps that it replaces, rounded up.
        left = static_cast<std::int64_t>(static_cast<double>(left) - jumps.next());
        const Cell to = Line::cell_of(jumps.at());
        if (cells_.tile(to) != here) look_up(to);
        block = {to.x >> 3 & 7, to.y >> 3 & 7};
      } while (left > 0 && is_empty(block));
      line.land(jumps.at(), left);
      continue;
    }

    // Follows the steps through all drawn squares of the region.
    const bool keeps_pace = line.keeps_pace(position);
    const std::int64_t first_i = line.i;
    const std::int64_t first_j = line.j;
    const std::int64_t last = line.last;
    std::int64_t border_i = first_i + line.x_to_border(at.x);
    std::int64_t border_j = first_j + line.y_to_border(at.y);
    std::int64_t borders = border_i + border_j;
    std::int64_t order = line.order(border_i, border_j);
    std::int64_t along_x = order >> 63;  // all ones: the next border is one along x
    for (bool is_first = true;; is_first = false) {
      if (region->blocks >> block.bit() & 1 && region->owners[block.bit()] != ray.body) {
        std::int64_t i = first_i;
        std::int64_t j = first_j;
        if (!is_first) {  // computes where the ray entered the block, only if needed
          border_j = borders - border_i;
          i = along_x ? border_i - k_block : line.x_steps(border_j - k_block);
          j = along_x ? line.y_steps(i) : border_j - k_block;
        }
        const Cell entry{at.x + step_x * static_cast<std::int32_t>(i - first_i),
                         at.y + step_y * static_cast<std::int32_t>(j - first_j)};
        if (met_in_block(*region, block.bit(), ray, line, entry, i, j, hit)) return hit;
      }
      if (borders - k_block >= last) return hit;
      along_x = order >> 63;
      const CellPosition before = block;
      block.step(step_x, step_y, along_x);
      if (!block.same_square(before) && (!block.inside() || !keeps_pace || is_empty(block))) break;
      borders += k_block;
      border_i += k_block & along_x;
      order += (both & along_x) - back;
    }
    border_j = borders - border_i;
    line.i = along_x ? border_i : line.x_steps(border_j);
    line.j = along_x ? line.y_steps(line.i) : border_j;
  }
  return hit;
}

/// Follows a ray through one block from the cell `at`, which the ray reaches after i steps along x and j
/// steps along y. Returns whether the ray hits a surface there. If the surface is nearer than range_max,
/// `hit` is set to it.
bool RayGrid::met_in_block(const Region& region, std::uint32_t block, const GridRay& ray, const Line& line,
                           Cell at, std::int64_t i, std::int64_t j, GridHit& hit) const {
  const std::uint64_t drawn = region.cells[block];
  const CellPosition entry(at.x & 7, at.y & 7);
  const std::int32_t step_x = line.step_x;
  const std::int32_t step_y = line.step_y;
  const std::int64_t back = 2 * line.across;
  const std::int64_t both = 2 * line.up + back;
  std::int64_t order = line.order(i + 1, j + 1);
  for (CellPosition cell = entry; cell.inside();) {
    if (drawn >> cell.bit() & 1) {
      if (const float most = met(marks_[region.marks[block] + rank(drawn, cell.bit())], ray); most >= 0) {
        i += std::abs(cell.x() - entry.x());
        j += std::abs(cell.y() - entry.y());
        const float range = line.range(i, j);
        if (i + j < line.last && range < ray.range_max) hit = {range, most};
        return true;
      }
    }
    const std::int64_t along_x = order >> 63;
    cell.step(step_x, step_y, along_x);
    order += (both & along_x) - back;
  }
  return false;
}

std::size_t RayGrid::fixed_bytes() const {
  return fixed_regions_ * sizeof(Region) + slots_.size() * sizeof(Slot) +
         fixed_marks_ * sizeof(std::uint32_t) + fixed_links_ * sizeof(Link);
}

}  // namespace troupe::partition
