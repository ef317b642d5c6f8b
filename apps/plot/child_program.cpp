#include "plot/child_program.h"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

extern char** environ;

namespace bayesian_icp::plot {

namespace {

/** A file without a name, in memory. */
class MemoryFile {
public:
  MemoryFile() : descriptor_(memfd_create("pcl_bayesian_icp", MFD_CLOEXEC))
  {
    if (descriptor_ < 0)
      throw std::system_error(errno, std::generic_category());
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile&
  operator=(const MemoryFile&) = delete;

  int
  descriptor() const
  {
    return descriptor_;
  }

  /** To be read by another program from its begin. */
  void
  fill(const std::string& text) const
  {
    std::size_t num_written = 0;
    while (num_written < text.size()) {
      const ssize_t count =
          write(descriptor_, text.data() + num_written, text.size() - num_written);
      if (count < 0 && errno != EINTR)
        throw std::system_error(errno, std::generic_category());
      num_written += count > 0 ? static_cast<std::size_t>(count) : 0;
    }
    lseek(descriptor_, 0, SEEK_SET);
  }

  std::string
  content() const
  {
    std::string text;
    char buffer[1 << 16];
    lseek(descriptor_, 0, SEEK_SET);
    while (true) {
      const ssize_t count = read(descriptor_, buffer, sizeof(buffer));
      if (count < 0 && errno == EINTR)
        continue;
      if (count <= 0)
        return text;
      text.append(buffer, static_cast<std::size_t>(count));
    }
  }

private:
  int descriptor_;
};

/** \return an error number, 0 if \p process has been started */
int
start(const std::vector<std::string>& words,
      const MemoryFile (&standard_files)[3],
      pid_t& process)
{
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words)
    arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (int i = 0; i < 3; ++i)
    posix_spawn_file_actions_adddup2(&actions, standard_files[i].descriptor(), i);
  // Of another group of processes: Ctrl-C at the terminal is for this program alone.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int error = posix_spawnp(
      &process, arguments.front(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

/** Whether \p process ends with exit code 0. */
bool
endsWell(pid_t process)
{
  int status = 0;
  while (waitpid(process, &status, 0) < 0)
    if (errno != EINTR)
      return false;
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

} // namespace

ProgramResult
runChildProgram(const std::vector<std::string>& words, const std::string& input)
{
  ProgramResult result;
  try {
    const MemoryFile standard_files[3];
    standard_files[0].fill(input);
    pid_t process = 0;
    const int error = start(words, standard_files, process);
    if (error != 0)
      throw std::system_error(error, std::generic_category());
    result.is_good = endsWell(process);
    result.output = standard_files[1].content();
    result.errors = standard_files[2].content();
  }
  catch (const std::system_error& error) {
    result.errors = error.code().message();
  }
  return result;
}

} // namespace bayesian_icp::plot
