#define GL_GLEXT_PROTOTYPES  // for the types of the functions; none is linked

#include "render/canvas.hpp"

#include "render/osmesa_context.hpp"

#include <GL/gl.h>
#include <GL/glext.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>

namespace troupe::render {
namespace {

/// Pictures are drawn in tiles of at most this side: 2048^2 pixels of 4 samples, colour and depth, take 134
/// MB, so a poster of 16384^2 needs no more than that beside its own pixels.
constexpr int k_tile = 2048;
constexpr int k_samples = 4;

// clang-format off
#define TROUPE_GL_FUNCTIONS(X) \
  X(glAttachShader) X(glBindBuffer) X(glBindFramebuffer) X(glBindRenderbuffer) X(glBindVertexArray) \
  X(glBlendFuncSeparate) X(glBlitFramebuffer) X(glBufferData) X(glCheckFramebufferStatus) \
  X(glClear) X(glClearColor) X(glCompileShader) X(glCreateProgram) X(glCreateShader) X(glDepthFunc) \
  X(glDrawArraysInstanced) X(glEnable) X(glEnableVertexAttribArray) X(glFramebufferRenderbuffer) \
  X(glGenBuffers) X(glGenFramebuffers) X(glGenRenderbuffers) X(glGenVertexArrays) X(glGetError) \
  X(glGetIntegerv) X(glGetProgramInfoLog) X(glGetProgramiv) X(glGetUniformLocation) \
  X(glLinkProgram) X(glPixelStorei) X(glReadPixels) X(glRenderbufferStorageMultisample) \
  X(glShaderSource) X(glUniform2f) X(glUseProgram) X(glVertexAttribDivisor) \
  X(glVertexAttribIPointer) X(glVertexAttribPointer) X(glViewport)
// clang-format on

struct Gl {
#define TROUPE_GL_MEMBER(name) decltype(&::name) name;
  TROUPE_GL_FUNCTIONS(TROUPE_GL_MEMBER)
#undef TROUPE_GL_MEMBER

  explicit Gl(const OsmesaContext& context) {
#define TROUPE_GL_LOAD(name) name = reinterpret_cast<decltype(name)>(context.procedure(#name));
    TROUPE_GL_FUNCTIONS(TROUPE_GL_LOAD)
#undef TROUPE_GL_LOAD
  }
};

// The picture's y points down and OpenGL's rows go up: turning y round here makes row 0 the top one.
constexpr const char* k_vertex_shader = R"(#version 330 core
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec2 offset;
layout(location = 2) in vec4 own;
layout(location = 3) in uint paint;
layout(location = 4) in vec4 place;
layout(location = 5) in vec2 z_size;
layout(location = 6) in vec4 body;
layout(location = 7) in vec4 edge;
layout(location = 8) in vec4 mark;
uniform vec2 picture;
uniform vec2 heights;
flat out vec4 color;
void main() {
  vec2 p = vertex.xy * z_size.y + offset;
  vec2 q = place.xy + vec2(p.x * place.z - p.y * place.w, p.x * place.w + p.y * place.z);
  float height = (z_size.x + vertex.z - heights.x) / heights.y;
  gl_Position = vec4(vec2(q.x, -q.y) * 2.0 / picture, 0.9 - 1.8 * height, 1.0);
  color = paint == 0u ? own : paint == 1u ? body : paint == 2u ? edge : mark;
}
)";

constexpr const char* k_fragment_shader = R"(#version 330 core
flat in vec4 color;
out vec4 pixel;
void main() { pixel = color; }
)";

GLuint link_program(const Gl& gl) {
  const GLuint program = gl.glCreateProgram();
  for (const auto& [kind, source] :
       {std::pair{GL_VERTEX_SHADER, k_vertex_shader}, std::pair{GL_FRAGMENT_SHADER, k_fragment_shader}}) {
    const GLuint shader = gl.glCreateShader(static_cast<GLenum>(kind));
    gl.glShaderSource(shader, 1, &source, nullptr);
    gl.glCompileShader(shader);
    gl.glAttachShader(program, shader);
  }
  gl.glLinkProgram(program);
  GLint linked = 0;
  gl.glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (!linked) {
    std::array<char, 1024> log{};
    gl.glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(fmt::format("cannot draw: the driver refuses the shaders: {}", log.data()));
  }
  return program;
}

/// A framebuffer object with one colour and one depth buffer. `samples` 0 is a plain one.
GLuint make_framebuffer(const Gl& gl, int width, int height, int samples) {
  GLuint framebuffer = 0;
  gl.glGenFramebuffers(1, &framebuffer);
  gl.glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  for (const auto& [attachment, format] :
       {std::pair{GL_COLOR_ATTACHMENT0, GL_RGBA8}, std::pair{GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24}}) {
    GLuint buffer = 0;
    gl.glGenRenderbuffers(1, &buffer);
    gl.glBindRenderbuffer(GL_RENDERBUFFER, buffer);
    gl.glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, static_cast<GLenum>(format), width, height);
    gl.glFramebufferRenderbuffer(GL_FRAMEBUFFER, static_cast<GLenum>(attachment), GL_RENDERBUFFER, buffer);
  }
  if (gl.glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE ||
      gl.glGetError() != GL_NO_ERROR) {
    throw std::runtime_error(
        fmt::format("cannot draw: the driver gives no framebuffer of {} x {} pixels", width, height));
  }
  return framebuffer;
}

void* byte_offset(std::size_t bytes) { return reinterpret_cast<void*>(bytes); }

/// The buffers of a layer, behind one vertex array object.
GLuint upload(const Gl& gl, const Layer& layer) {
  GLuint array = 0;
  std::array<GLuint, 2> buffers{};
  gl.glGenVertexArrays(1, &array);
  gl.glBindVertexArray(array);
  gl.glGenBuffers(2, buffers.data());

  const auto floats = [&](GLuint location, GLint count, GLsizei stride, std::size_t offset) {
    gl.glEnableVertexAttribArray(location);
    gl.glVertexAttribPointer(location, count, GL_FLOAT, GL_FALSE, stride, byte_offset(offset));
  };
  const auto color = [&](GLuint location, GLsizei stride, std::size_t offset) {
    gl.glEnableVertexAttribArray(location);
    gl.glVertexAttribPointer(location, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, byte_offset(offset));
  };

  gl.glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  gl.glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(layer.mesh.size() * sizeof(Vertex)),
                  layer.mesh.data(), GL_STATIC_DRAW);
  floats(0, 3, sizeof(Vertex), offsetof(Vertex, x));
  floats(1, 2, sizeof(Vertex), offsetof(Vertex, offset_x));
  color(2, sizeof(Vertex), offsetof(Vertex, own));
  gl.glEnableVertexAttribArray(3);
  gl.glVertexAttribIPointer(3, 1, GL_UNSIGNED_INT, sizeof(Vertex), byte_offset(offsetof(Vertex, paint)));

  gl.glBindBuffer(GL_ARRAY_BUFFER, buffers[1]);
  gl.glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(layer.instances.size() * sizeof(Instance)),
                  layer.instances.data(), GL_STATIC_DRAW);
  floats(4, 4, sizeof(Instance), offsetof(Instance, x));
  floats(5, 2, sizeof(Instance), offsetof(Instance, z));
  color(6, sizeof(Instance), offsetof(Instance, body));
  color(7, sizeof(Instance), offsetof(Instance, edge));
  color(8, sizeof(Instance), offsetof(Instance, mark));
  for (GLuint location = 4; location <= 8; ++location) gl.glVertexAttribDivisor(location, 1);
  return array;
}

/// The interval of heights that the depth buffer has to tell apart.
ZInterval heights_of(std::span<const Layer> layers) {
  ZInterval all{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const Layer& layer : layers) {
    if (layer.mesh.empty() || layer.instances.empty()) continue;
    const auto [low, high] = std::ranges::minmax_element(layer.mesh, {}, &Vertex::z);
    const auto [bottom, top] = std::ranges::minmax_element(layer.instances, {}, &Instance::z);
    all.min = std::min<double>(all.min, low->z + bottom->z);
    all.max = std::max<double>(all.max, high->z + top->z);
  }
  return all.min < all.max ? all : ZInterval{all.min, all.min + 1};
}

void check_size(const Gl& gl, int width, int height) {
  std::array<GLint, 2> limit{};
  gl.glGetIntegerv(GL_MAX_VIEWPORT_DIMS, limit.data());
  if (width < 1 || height < 1 || width > limit[0] || height > limit[1]) {
    throw std::runtime_error(
        fmt::format("cannot draw a picture of {} x {} pixels: each side must be at least 1, "
                    "and this driver draws at most {} x {}",
                    width, height, limit[0], limit[1]));
  }
}

}  // namespace

Picture paint(int width, int height, Rgba ground, std::span<const Layer> layers) {
  // Everything made in the context goes with it. It is not kept for the next picture: a context belongs to
  // the thread that made it, and making one costs milliseconds.
  const OsmesaContext context;
  const Gl gl(context);
  check_size(gl, width, height);

  const GLuint program = link_program(gl);
  const ZInterval heights = heights_of(layers);
  gl.glUseProgram(program);
  gl.glUniform2f(gl.glGetUniformLocation(program, "picture"), static_cast<float>(width),
                 static_cast<float>(height));
  gl.glUniform2f(gl.glGetUniformLocation(program, "heights"), static_cast<float>(heights.min),
                 static_cast<float>(heights.max - heights.min));
  std::vector<GLuint> arrays;
  for (const Layer& layer : layers) arrays.push_back(upload(gl, layer));

  GLint samples = 0;
  gl.glGetIntegerv(GL_MAX_SAMPLES, &samples);
  const int tile_width = std::min(width, k_tile);
  const int tile_height = std::min(height, k_tile);
  const GLuint resolved = make_framebuffer(gl, tile_width, tile_height, 0);
  const GLuint drawn = make_framebuffer(gl, tile_width, tile_height, std::min(k_samples, samples));

  gl.glEnable(GL_BLEND);
  gl.glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl.glEnable(GL_DEPTH_TEST);
  gl.glDepthFunc(GL_LEQUAL);
  gl.glClearColor(ground[0] / 255.0F, ground[1] / 255.0F, ground[2] / 255.0F, ground[3] / 255.0F);
  gl.glPixelStorei(GL_PACK_ROW_LENGTH, width);

  Picture picture{width, height, std::vector<std::uint8_t>(4 * static_cast<std::size_t>(width) * height)};
  for (int top = 0; top < height; top += tile_height) {
    for (int left = 0; left < width; left += tile_width) {
      const int columns = std::min(tile_width, width - left);
      const int rows = std::min(tile_height, height - top);
      gl.glBindFramebuffer(GL_FRAMEBUFFER, drawn);
      gl.glViewport(-left, -top, width, height);
      gl.glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
      for (std::size_t i = 0; i < layers.size(); ++i) {
        if (layers[i].on_top) gl.glClear(GL_DEPTH_BUFFER_BIT);
        gl.glBindVertexArray(arrays[i]);
        gl.glDrawArraysInstanced(GL_TRIANGLES, 0, static_cast<GLsizei>(layers[i].mesh.size()),
                                 static_cast<GLsizei>(layers[i].instances.size()));
      }
      gl.glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved);
      gl.glBlitFramebuffer(0, 0, columns, rows, 0, 0, columns, rows, GL_COLOR_BUFFER_BIT, GL_NEAREST);
      gl.glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved);
      gl.glReadPixels(0, 0, columns, rows, GL_RGBA, GL_UNSIGNED_BYTE,
                      picture.rgba.data() + 4 * (static_cast<std::size_t>(top) * width + left));
    }
  }
  if (const GLenum error = gl.glGetError(); error != GL_NO_ERROR) {
    throw std::runtime_error(fmt::format("cannot draw: OpenGL error {:#06x}{}", error,
                                         error == GL_OUT_OF_MEMORY ? " (out of memory)" : ""));
  }
  return picture;
}

}  // namespace troupe::render
