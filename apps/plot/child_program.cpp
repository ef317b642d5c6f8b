#include "plot/child_program.h"

#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <system_error>

extern char** environ;

namespace bayesian_icp::plot {

namespace {

/** A file without a name, in memory. */
using MemoryFile = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

/** To be read by another program from its begin. */
MemoryFile
memoryFileWith(const std::string& content)
{
  const int descriptor = memfd_create("pcl_bayesian_icp", MFD_CLOEXEC);
  MemoryFile file(descriptor < 0 ? nullptr : fdopen(descriptor, "w+"), &std::fclose);
  if (!file ||
      std::fwrite(content.data(), 1, content.size(), file.get()) != content.size() ||
      std::fflush(file.get()) != 0)
    throw std::system_error(errno, std::generic_category());
  std::rewind(file.get());
  return file;
}

/** What another program has written. */
std::string
contentOf(const MemoryFile& file)
{
  std::string content;
  std::array<char, 1 << 16> buffer;
  std::rewind(file.get());
  while (const auto count = std::fread(buffer.data(), 1, buffer.size(), file.get()))
    content.append(buffer.data(), count);
  return content;
}

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
    posix_spawn_file_actions_adddup2(&actions, fileno(standard_files[i].get()), i);
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
    const MemoryFile standard_files[] = {
        memoryFileWith(input), memoryFileWith(""), memoryFileWith("")};
    pid_t process = 0;
    const int error = start(words, standard_files, process);
    if (error != 0)
      throw std::system_error(error, std::generic_category());
    result.is_good = endsWell(process);
    result.output = contentOf(standard_files[1]);
    result.errors = contentOf(standard_files[2]);
  }
  catch (const std::system_error& error) {
    result.errors = error.code().message();
  }
  return result;
}

} // namespace bayesian_icp::plot
