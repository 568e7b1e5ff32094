// Results of runs in the folder of a sweep: results/NNNN.jsonl, a line per run, a file per process. Lines are found by a
// hash of what was run, not by number: an edited sweep reuses the results that still hold.
#pragma once
#include <map>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

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

/// The line of a run: its metrics, those of joints as "max_error.elbow".
std::string result_line(const std::string& key, const nlohmann::json& evaluated);

/// Threads may share one.
class Results {
 public:
  /// Rows have these metrics. The folder need not exist yet.
  Results(std::string dir, std::vector<std::string> metrics);

  /// Whether a folder holds results, or nothing yet.
  static bool are_in(const std::string& dir);
  /// Reads what is there, or has been added since. A line that is cut off, as by a full disk, is ignored.
  void load();
  std::optional<Row> find(const std::string& key) const;
  /// Appends a whole line to the file of this process. Throws std::runtime_error if it cannot be written.
  Row add(const std::string& line);
  size_t size() const;

 private:
  std::optional<Row> read(const std::string& line) const;
  void open();

  const std::string dir_;
  const std::vector<std::string> metrics_;
  mutable std::mutex lock_;
  std::map<std::string, Row> rows_;
  std::map<std::string, std::streamoff> read_to_;  ///< how far each file has been read
  std::string file_;
  int descriptor_ = -1;
};

}  // namespace lab::sweep
