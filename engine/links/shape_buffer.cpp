#include "engine/links/shape_buffer.hpp"

#include <algorithm>
#include <limits>

namespace troupe::engine {

void ShapeBuffer::reserve(std::size_t pieces, std::size_t corners) {
  shape_.pieces.reserve(pieces);
  shape_.circles.reserve(pieces);
  spare_.reserve(pieces);
  while (spare_.size() < pieces) spare_.emplace_back().reserve(corners);
}

void ShapeBuffer::begin() { used_ = 0; }

void ShapeBuffer::add(const ConvexPrism& piece, const Mount& mount) {
  if (used_ == shape_.pieces.size()) {
    ConvexPrism& added = shape_.pieces.emplace_back();
    if (!spare_.empty()) {
      added.outline = std::move(spare_.back());
      spare_.pop_back();
    }
  }
  ConvexPrism& out = shape_.pieces[used_++];
  out.outline.clear();
  for (const Vec2& v : piece.outline) out.outline.push_back(mount.transform * v);
  out.z = piece.z.shifted(mount.z);
}

void ShapeBuffer::finish(double thinnest) {
  while (shape_.pieces.size() > used_) {
    spare_.push_back(std::move(shape_.pieces.back().outline));
    shape_.pieces.pop_back();
  }
  double radius2 = 0;
  shape_.vertices = 0;
  shape_.circles.clear();
  shape_.z = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const ConvexPrism& piece : shape_.pieces) {
    shape_.circles.push_back(partition::circle_about(piece.outline));
    shape_.vertices += piece.outline.size();
    for (const Vec2& v : piece.outline) radius2 = std::max(radius2, v.squaredNorm());
    shape_.z.min = std::min(shape_.z.min, piece.z.min);
    shape_.z.max = std::max(shape_.z.max, piece.z.max);
  }
  shape_.radius = sqrt(radius2);
  shape_.thinnest = thinnest;
  if (shape_.pieces.empty()) shape_.z = {};
}

}  // namespace troupe::engine
