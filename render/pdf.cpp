#include "render/vector_drawing.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <memory>
#include <stdexcept>

namespace troupe::render {
namespace {

// The part of cairo's interface that is used here. Its ABI has been stable since version 1.2. The library is
// loaded when the first PDF is drawn: so a build needs no headers of cairo, and a run without PDFs does not
// load it.
struct CairoSurface;
struct CairoContext;
using CairoWrite = int (*)(void* closure, const unsigned char* data, unsigned length);
struct CairoExtents {
  double x_bearing, y_bearing, width, height, x_advance, y_advance;
};
constexpr int k_success = 0;  // cairo_status_t
constexpr int k_write_error = 11;
// cairo_pdf_metadata_t
constexpr int k_metadata_title = 0, k_metadata_subject = 2, k_metadata_creator = 4, k_metadata_created = 5;
constexpr int k_square_cap = 2, k_miter_join = 0, k_round_join = 1;
constexpr int k_normal = 0;  // slant and weight of a font

/// The functions of a loaded library. The constructor throws std::runtime_error if one of them is missing.
class Cairo {
  /// The address of a function, which converts to the type of its pointer.
  struct Address {
    void* address;
    template <class Function>
    operator Function*() const {  // NOLINT(google-explicit-constructor)
      return reinterpret_cast<Function*>(address);
    }
  };
  Address find(const std::string& name) const {
    void* const address = dlsym(library_, ("cairo_" + name).c_str());
    if (address) return {address};
    throw std::runtime_error(fmt::format(
        "cannot draw a PDF: the installed cairo has no function cairo_{}; version 1.16 or later is needed "
        "(Debian, Ubuntu: apt install libcairo2)",
        name));
  }

  void* library_;  // first, because the members below use it

 public:
  explicit Cairo(void* library) : library_(library) {}

  CairoSurface* (*pdf_surface_create_for_stream)(CairoWrite, void*, double,
                                                 double) = find("pdf_surface_create_for_stream");
  void (*pdf_surface_set_metadata)(CairoSurface*, int, const char*) = find("pdf_surface_set_metadata");
  void (*surface_finish)(CairoSurface*) = find("surface_finish");
  int (*surface_status)(CairoSurface*) = find("surface_status");
  void (*surface_destroy)(CairoSurface*) = find("surface_destroy");
  CairoContext* (*create)(CairoSurface*) = find("create");
  void (*destroy)(CairoContext*) = find("destroy");
  int (*status)(CairoContext*) = find("status");
  const char* (*status_to_string)(int) = find("status_to_string");
  void (*scale)(CairoContext*, double, double) = find("scale");
  void (*set_source_rgba)(CairoContext*, double, double, double, double) = find("set_source_rgba");
  void (*set_line_width)(CairoContext*, double) = find("set_line_width");
  void (*set_line_cap)(CairoContext*, int) = find("set_line_cap");
  void (*set_line_join)(CairoContext*, int) = find("set_line_join");
  void (*move_to)(CairoContext*, double, double) = find("move_to");
  void (*line_to)(CairoContext*, double, double) = find("line_to");
  void (*close_path)(CairoContext*) = find("close_path");
  void (*paint)(CairoContext*) = find("paint");
  void (*fill)(CairoContext*) = find("fill");
  void (*stroke)(CairoContext*) = find("stroke");
  void (*select_font_face)(CairoContext*, const char*, int, int) = find("select_font_face");
  void (*set_font_size)(CairoContext*, double) = find("set_font_size");
  void (*text_extents)(CairoContext*, const char*, CairoExtents*) = find("text_extents");
  void (*text_path)(CairoContext*, const char*) = find("text_path");
  void (*show_text)(CairoContext*, const char*) = find("show_text");
};

void* load_cairo() {
  std::string reasons;
  for (const char* name : {"libcairo.so.2", "libcairo.so"}) {
    if (void* const library = dlopen(name, RTLD_NOW | RTLD_LOCAL)) return library;
    const char* const reason = dlerror();
    reasons += fmt::format("{}{}", reasons.empty() ? "" : "; ", reason ? reason : name);
  }
  throw std::runtime_error(fmt::format(
      "cannot draw a PDF: cairo is not installed (Debian, Ubuntu: apt install libcairo2): {}", reasons));
}

const Cairo& cairo() {
  static const Cairo functions(load_cairo());
  return functions;
}

int append(void* closure, const unsigned char* data, unsigned length) {
  try {
    static_cast<std::string*>(closure)->append(reinterpret_cast<const char*>(data), length);
    return k_success;
  } catch (...) {  // exceptions must not propagate through C code
    return k_write_error;
  }
}

class Page {
 public:
  Page(const Cairo& c, CairoContext* context) : c_(c), context_(context) {
    c_.set_line_cap(context_, k_square_cap);
    c_.select_font_face(context_, "sans-serif", k_normal, k_normal);
    c_.set_font_size(context_, 100);
    CairoExtents capital{};
    c_.text_extents(context_, "H", &capital);
    size_of_cap_height_ = capital.height > 0 ? 100 / capital.height : 1.4;
  }

  void operator()(const VectorPath& path) const {
    use(path.color);
    for (const Ring& ring : path.rings) {
      c_.move_to(context_, ring.front().x(), ring.front().y());
      for (std::size_t i = 1; i < ring.size(); ++i) c_.line_to(context_, ring[i].x(), ring[i].y());
      if (path.width == 0 || path.is_closed) c_.close_path(context_);
    }
    if (path.width == 0) {
      c_.fill(context_);
    } else {
      c_.set_line_join(context_, k_miter_join);
      c_.set_line_width(context_, path.width);
      c_.stroke(context_);
    }
  }

  void operator()(const VectorText& text) const {
    c_.set_font_size(context_, text.cap_height * size_of_cap_height_);
    CairoExtents extents{};
    if (text.ends_at_pen) c_.text_extents(context_, text.text.c_str(), &extents);
    const double x = text.pen.x() - extents.x_advance;
    c_.move_to(context_, x, text.pen.y());
    c_.text_path(context_, text.text.c_str());
    use(text.halo);
    c_.set_line_join(context_, k_round_join);
    c_.set_line_width(context_, 2 * text.halo_width);
    c_.stroke(context_);
    use(text.color);
    c_.move_to(context_, x, text.pen.y());
    c_.show_text(context_, text.text.c_str());
  }

  void use(Rgba color) const {
    c_.set_source_rgba(context_, color[0] / 255.0, color[1] / 255.0, color[2] / 255.0, color[3] / 255.0);
  }

 private:
  const Cairo& c_;
  CairoContext* context_;
  double size_of_cap_height_ = 1.4;  // font size per height of capitals
};

}  // namespace

std::string pdf_text(const VectorDrawing& drawing, const FileTexts& texts) {
  constexpr double k_points_a_pixel = 72.0 / 96;
  const Cairo& c = cairo();
  std::string pdf;
  const std::unique_ptr<CairoSurface, void (*)(CairoSurface*)> surface(
      c.pdf_surface_create_for_stream(append, &pdf, drawing.width * k_points_a_pixel,
                                      drawing.height * k_points_a_pixel),
      c.surface_destroy);
  std::string subject;
  for (const auto& [key, value] : texts) {
    subject += fmt::format("{}{}: {}", subject.empty() ? "" : "; ", key, value);
    if (key == "world") c.pdf_surface_set_metadata(surface.get(), k_metadata_title, value.c_str());
    if (key == "Software") c.pdf_surface_set_metadata(surface.get(), k_metadata_creator, value.c_str());
  }
  c.pdf_surface_set_metadata(surface.get(), k_metadata_subject, subject.c_str());
  // Without a date, equal drawings give equal bytes. By default, cairo stores the present time.
  c.pdf_surface_set_metadata(surface.get(), k_metadata_created, nullptr);
  int status = k_success;
  {
    const std::unique_ptr<CairoContext, void (*)(CairoContext*)> context(c.create(surface.get()), c.destroy);
    c.scale(context.get(), k_points_a_pixel, k_points_a_pixel);
    const Page page(c, context.get());
    if (drawing.ground[3] != 0) {
      page.use(drawing.ground);
      c.paint(context.get());
    }
    for (const auto& item : drawing.items) std::visit(page, item);
    status = c.status(context.get());
  }
  c.surface_finish(surface.get());
  if (status == k_success) status = c.surface_status(surface.get());
  if (status != k_success)
    throw std::runtime_error(fmt::format("cannot draw a PDF: cairo failed: {}", c.status_to_string(status)));
  return pdf;
}

}  // namespace troupe::render
