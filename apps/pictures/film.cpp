#include "apps/pictures/film.hpp"

#include "apps/interrupt.hpp"
#include "apps/outputs.hpp"
#include "worldio/results/descriptor.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

namespace troupe::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* k_no_ffmpeg =
    "ffmpeg is not installed (Debian, Ubuntu: apt install ffmpeg); --film frames/%06d.png writes single "
    "pictures instead";
constexpr int k_last_open_file = 1023;  // file descriptors up to this one are closed in ffmpeg's process
constexpr int k_pipe_bytes = 1 << 20;   // requested capacity of the pipe to ffmpeg

void close_if_open(int& file) {
  if (file >= 0) close(file);
  file = -1;
}

}  // namespace

std::string find_ffmpeg() {
  const char* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "/usr/local/bin:/usr/bin:/bin");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const fs::path program = fs::path(folder.empty() ? "." : folder) / "ffmpeg";
    std::error_code ignored;
    if (fs::is_regular_file(program, ignored) && access(program.c_str(), X_OK) == 0) return program.string();
  }
  return {};
}

void check_film(const PictureFiles& pictures) {
  if (pictures.film.empty() || is_frames(pictures.film)) return;
  if (pictures.look.background == "transparent")
    refuse_output(pictures.film,
                  "a film cannot be transparent: give another --background, or write single pictures, which "
                  "can be transparent, with --film frames/%06d.png");
  if (find_ffmpeg().empty()) refuse_output(pictures.film, k_no_ffmpeg);
}

Ffmpeg::Ffmpeg(fs::path film, int width, int height, double fps) : film_(std::move(film)) {
  const std::string program = find_ffmpeg();
  if (program.empty()) refuse_output(film_, k_no_ffmpeg);
  try {
    partial_.emplace(film_, ".mp4");
  } catch (const std::system_error& error) {
    refuse_output(film_, error.code().message());
  }
  remove_when_killed(partial_->path());
  // Video players need even widths and heights and the pixel format yuv420p, which stores colours at half the
  // resolution. `crf` 18 keeps thin lines. The preset takes half the time of the default preset and makes
  // films of the same size. By default, ffmpeg converts colours by the matrix of BT.601 and does not say so
  // in the file: players then take that of BT.709 for large films, and show orange and green in wrong shades.
  start(
      program,
      {"ffmpeg",
       "-y",
       "-xerror",  // otherwise, the exit code is 0 although the end of the film cannot be written
       "-loglevel",
       "error",
       "-f",
       "rawvideo",
       "-pixel_format",
       "rgba",
       "-video_size",
       fmt::format("{}x{}", width, height),
       "-framerate",
       fmt::format("{:g}", fps),
       "-i",
       "-",
       "-vf",
       "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv",
       "-c:v",
       "libx264",
       "-preset",
       "veryfast",
       "-crf",
       "18",
       "-pix_fmt",
       "yuv420p",
       "-colorspace",
       "bt709",
       "-color_primaries",
       "bt709",
       "-color_trc",
       "bt709",
       "-color_range",
       "tv",
       "-movflags",
       "+faststart",
       "file:" + partial_->path().string()});  // without "file:", ffmpeg takes "http:film.mp4" for a protocol
}

Ffmpeg::~Ffmpeg() {
  if (process_ >= 0) {
    close_if_open(pipe_);
    kill(process_, SIGTERM);
    wait();
  }
  partial_.reset();
  remove_when_killed({});
}

void Ffmpeg::start(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) refuse_output(film_, std::strerror(errno));
  fcntl(ends[1], F_SETPIPE_SZ, k_pipe_bytes);  // fails harmlessly if the kernel allows less
  std::signal(SIGPIPE, SIG_IGN);               // if ffmpeg has ended, write() reports it
  process_ = fork();
  if (process_ == 0) {
    // ffmpeg gets a process group of its own, because Ctrl-C must not end it: Ctrl-C ends the run, which then
    // finishes the film.
    setpgid(0, 0);
    const int nothing = open("/dev/null", O_WRONLY);
    dup2(ends[0], STDIN_FILENO);
    dup2(nothing, STDOUT_FILENO);
    // Keep the descriptor with the lock on the film: ffmpeg may outlive this process and still write.
    for (int file = STDERR_FILENO + 1; file <= k_last_open_file; ++file)
      if (file != partial_->descriptor()) close(file);
    fcntl(partial_->descriptor(), F_SETFD, 0);
    execv(program.c_str(), words.data());
    _exit(127);
  }
  const int error = errno;
  close(ends[0]);
  pipe_ = ends[1];
  if (process_ < 0) {
    close_if_open(pipe_);
    refuse_output(film_, std::strerror(error));
  }
}

void Ffmpeg::write(std::span<const std::uint8_t> rgba) {
  if (worldio::write_all(pipe_, {reinterpret_cast<const char*>(rgba.data()), rgba.size()})) return;
  close_if_open(pipe_);
  fail(process_ >= 0 ? wait() : 0);
}

int Ffmpeg::wait() {
  int status = 0;
  while (waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void Ffmpeg::fail(int exit_code) const {
  throw std::runtime_error(fmt::format(
      "{}: error: writing failed: ffmpeg ended with exit code {}; its messages, if any, are above",
      film_.string(), exit_code));
}

void Ffmpeg::finish() {
  close_if_open(pipe_);
  if (const int code = wait(); code != 0) fail(code);
  try {
    partial_->commit();
  } catch (const std::system_error& error) {
    throw std::runtime_error(
        fmt::format("{}: error: writing failed: {}", film_.string(), error.code().message()));
  }
}

}  // namespace troupe::apps
