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

struct Cairo {
  CairoSurface* (*pdf_surface_create_for_stream)(CairoWrite, void*, double, double);
  void (*pdf_surface_set_metadata)(CairoSurface*, int, const char*);
  void (*surface_finish)(CairoSurface*);
  int (*surface_status)(CairoSurface*);
  void (*surface_destroy)(CairoSurface*);
  CairoContext* (*create)(CairoSurface*);
  void (*destroy)(CairoContext*);
  int (*status)(CairoContext*);
  const char* (*status_to_string)(int);
  void (*scale)(CairoContext*, double, double);
  void (*set_source_rgba)(CairoContext*, double, double, double, double);
  void (*set_line_width)(CairoContext*, double);
  void (*set_line_cap)(CairoContext*, int);
  void (*set_line_join)(CairoContext*, int);
  void (*move_to)(CairoContext*, double, double);
  void (*line_to)(CairoContext*, double, double);
  void (*close_path)(CairoContext*);
  void (*paint)(CairoContext*);
  void (*fill)(CairoContext*);
  void (*stroke)(CairoContext*);
  void (*select_font_face)(CairoContext*, const char*, int, int);
  void (*set_font_size)(CairoContext*, double);
  void (*text_extents)(CairoContext*, const char*, CairoExtents*);
  void (*text_path)(CairoContext*, const char*);
  void (*show_text)(CairoContext*, const char*);
};

const Cairo& cairo() {
  static const Cairo functions = [] {
    constexpr std::array k_names = {"libcairo.so.2", "libcairo.so"};
    void* library = nullptr;
    std::string reasons;
    for (const char* name : k_names) {
      library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
      if (library) break;
      const char* const reason = dlerror();
      reasons += fmt::format("{}{}", reasons.empty() ? "" : "; ", reason ? reason : name);
    }
    if (!library)
      throw std::runtime_error(fmt::format(
          "cannot draw a PDF: cairo is not installed (Debian, Ubuntu: apt install libcairo2): {}", reasons));
    Cairo found{};
    const auto find = [library](auto& function, const char* name) {
      void* const address = dlsym(library, name);
      if (!address)
        throw std::runtime_error(fmt::format(
            "cannot draw a PDF: the installed cairo has no function {}; version 1.16 or later is needed "
            "(Debian, Ubuntu: apt install libcairo2)",
            name));
      function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(address);
    };
#define TROUPE_CAIRO(name) find(found.name, "cairo_" #name)
    TROUPE_CAIRO(pdf_surface_create_for_stream);
    TROUPE_CAIRO(pdf_surface_set_metadata);
    TROUPE_CAIRO(surface_finish);
    TROUPE_CAIRO(surface_status);
    TROUPE_CAIRO(surface_destroy);
    TROUPE_CAIRO(create);
    TROUPE_CAIRO(destroy);
    TROUPE_CAIRO(status);
    TROUPE_CAIRO(status_to_string);
    TROUPE_CAIRO(scale);
    TROUPE_CAIRO(set_source_rgba);
    TROUPE_CAIRO(set_line_width);
    TROUPE_CAIRO(set_line_cap);
    TROUPE_CAIRO(set_line_join);
    TROUPE_CAIRO(move_to);
    TROUPE_CAIRO(line_to);
    TROUPE_CAIRO(close_path);
    TROUPE_CAIRO(paint);
    TROUPE_CAIRO(fill);
    TROUPE_CAIRO(stroke);
    TROUPE_CAIRO(select_font_face);
    TROUPE_CAIRO(set_font_size);
    TROUPE_CAIRO(text_extents);
    TROUPE_CAIRO(text_path);
    TROUPE_CAIRO(show_text);
#undef TROUPE_CAIRO
    return found;
  }();
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
