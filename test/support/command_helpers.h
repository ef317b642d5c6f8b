/** \file
 * \brief Running a command line tool from a test and reading what it wrote.
 */
#pragma once

#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

struct CommandResult {
  /** -1 if the shell did not end by itself. */
  int exit_code;
  /** Standard output and standard error. */
  std::string output;
};

/** \brief Run a command by the shell and wait for its end. */
inline CommandResult
runShell(const std::string& command)
{
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer;
  while (const std::size_t size = fread(buffer.data(), 1, buffer.size(), pipe))
    output.append(buffer.data(), size);
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}

/** \brief The bytes of a file; the test fails if it cannot be read. */
inline std::string
contentOf(const std::filesystem::path& path)
{
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

inline void
writeFile(const std::filesystem::path& path, const std::string& content)
{
  std::ofstream(path, std::ios::binary) << content;
}

/** \brief Runs each test in an empty folder of its own. */
class FolderTest : public testing::Test {
protected:
  void
  SetUp() override
  {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              (std::string(test->test_suite_name()) + "_" + test->name() + "_" +
               std::to_string(getpid()));
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }

  void
  TearDown() override
  {
    std::filesystem::remove_all(folder_);
  }

  std::filesystem::path folder_;
};
