#pragma once
#include <map>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

/// What runs have left in a sweep's folder: results/NNNN.jsonl, a line a run, a file for each process that worked. Lines
/// are found by the key of what was run, not by number: an edited sweep takes from its folder what still holds.
namespace lab::sweep {

/// One run of the table.
struct Row {
  enum class State { Missing, Done, Unable };  ///< Unable: it could not be run; `reason` says why
  State state = State::Missing;
  std::string key;
  int64_t last_step = 0;
  bool complete = false, passed = false;
  std::string reason;           ///< why it ended early or could not be run
  std::vector<double> metrics;  ///< in the order of the sweep's; NaN = no value. Empty unless complete
};

/// The line of a run: what `evaluate` made of it, per joint as "max_error.elbow".
std::string result_line(const std::string& key, const nlohmann::json& evaluated);

/// Threads may share one.
class Results {
 public:
  /// Rows have these metrics. The folder need not be there yet.
  Results(std::string dir, std::vector<std::string> metrics);

  /// Reads what is there, or has come since. A line that is cut off, as by a full disk, counts as not there.
  void load();
  std::optional<Row> find(const std::string& key) const;
  /// Takes a line, and appends it, whole, to this process' file. Throws std::runtime_error if it cannot be written.
  Row add(const std::string& line);
  size_t size() const;

 private:
  std::optional<Row> read(const std::string& line) const;
  void open();

  const std::string dir_;
  const std::vector<std::string> metrics_;
  mutable std::mutex lock_;
  std::map<std::string, Row> rows_;
  std::map<std::string, std::streamoff> read_to_;  ///< how much of each file is known
  std::string file_;
  int descriptor_ = -1;
};

}  // namespace lab::sweep
