// Files of runs: rows come back as they went, and only whole ones; other files are
// refused.
#include "evaluation/csv_rows.h"
#include "io/errors.h"
#include "study/run_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <thread>

using namespace bayesian_icp;
using namespace bayesian_icp::evaluate;
namespace fs = std::filesystem;

namespace {

/** A run with a column of each type. */
struct SomeRun {
  static constexpr int num_name_columns = 2;

  struct Name {
    std::string word;
    std::uint64_t seed = 0;
  };

  Name name;
  bool is_valid = false;
  double number = 0.0;
  std::string notes;

  template <typename Column>
  void
  columns(const Column& column)
  {
    column("word", name.word);
    column("seed", name.seed);
    column("valid", is_valid);
    column("number", number);
    column("notes", notes);
  }
};

class RunFiles : public FolderTest {
protected:
  std::string
  file() const
  {
    return (folder_ / "new/runs.csv").string();
  }
};

} // namespace

TEST_F(RunFiles, RowsComeBackAsTheyWent)
{
  const std::uint64_t seed = std::numeric_limits<std::uint64_t>::max();
  RunFile<SomeRun>(file()).add({{"a word", seed}, true, 0.1, "x;a, b\nc"});
  EXPECT_EQ(contentOf(file()),
            "word,seed,valid,number,notes,version\n"
            "a word,18446744073709551615,1,0.1,x;a  b c," BAYESIAN_ICP_VERSION "\n");
  RunFile<SomeRun> again(file());
  const SomeRun* const run = again.find({"a word", seed});
  ASSERT_NE(run, nullptr);
  EXPECT_TRUE(run->is_valid);
  EXPECT_EQ(run->number, 0.1);
  EXPECT_EQ(run->notes, "x;a  b c");
  EXPECT_EQ(again.find({"a word", 1}), nullptr);
  EXPECT_TRUE(
      std::isnan(runOf<SomeRun>(rowOf(SomeRun{{}, false, std::nan(""), ""})).number));
}

TEST_F(RunFiles, ARowThatWasCutOffIsMadeAgain)
{
  {
    RunFile<SomeRun> runs(file());
    runs.add({{"a", 1}, true, 1.0, ""});
    runs.add({{"a", 2}, true, 2.0, ""});
  }
  const std::string content = contentOf(file());
  // The last row was being written when the power went.
  fs::resize_file(file(), content.size() - 1);
  RunFile<SomeRun> runs(file());
  EXPECT_EQ(runs.runs().size(), 1u);
  int num_made = 0;
  for (const std::uint64_t seed : {1, 2}) {
    const SomeRun& run = runs.findOrMake({"a", seed}, [&] {
      ++num_made;
      return SomeRun{{"a", seed}, true, static_cast<double>(seed), ""};
    });
    EXPECT_EQ(run.name.seed, seed);
  }
  EXPECT_EQ(num_made, 1);
  EXPECT_EQ(contentOf(file()), content);
}

TEST_F(RunFiles, OtherFilesAreRefused)
{
  RunFile<SomeRun> runs(file());
  const std::string header = contentOf(file());
  const std::string end = "," BAYESIAN_ICP_VERSION "\n";
  for (const auto& [content, complaint] :
       {std::pair<std::string, std::string>{"x,y\n",
                                            "is not a file of results of version"},
        {headerOf<SomeRun>() + '\n', "move it away, or choose another --output"},
        {header + "a,1,1,0.5,,0.0.9\n", "is not a file of results of version"},
        {header + "a\n", "is not a file of results of version"},
        {header + "a,1,1,0.5" + end, "bad line 'a,1,1,0.5,"},
        {header + "a,1,1,0.5,," + end, "bad line"},
        {header + "a,1,1,0.5.," + end, "bad line"},
        {header + "a,-1,1,0.5," + end, "bad line"},
        {header + "a,1,2,0.5," + end, "bad line"}}) {
    const std::string other = (folder_ / "other.csv").string();
    writeFile(other, content);
    try {
      const RunFile<SomeRun> read(other);
      FAIL() << content;
    }
    catch (const io::FileError& error) {
      expectIn(error.what(), other);
      expectIn(error.what(), complaint);
    }
  }
  EXPECT_THROW(RunFile<SomeRun>{file()}, io::FileError) << "in use";
}

TEST_F(RunFiles, ThreadsMayAddAtATime)
{
  constexpr std::uint64_t num_runs = 200;
  RunFile<SomeRun> runs(file());
  const auto add = [&runs](const std::string& word) {
    for (std::uint64_t seed = 0; seed < num_runs; ++seed)
      runs.add({{word, seed}, true, 0.0, ""});
  };
  std::thread other([&add] { add("a"); });
  add("b");
  other.join();
  EXPECT_EQ(runs.runs().size(), 2 * num_runs);
  EXPECT_NE(runs.find({"a", num_runs - 1}), nullptr);
}
