// What came of `lab run`, for machines: JSON, and JUnit XML for CI systems.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lab {

/// name, folder, exit_code, verdict (ok, failed, error, stopped), reason, the verdicts of `expect`, all metrics. `run_dir` may be
/// empty: nothing has run, and `reason` says why.
nlohmann::ordered_json run_verdict(const std::string& run_dir, const std::string& name, int exit_code,
                                   const std::string& reason);

/// One test suite: a test case for each bound of `expect`, and one for the run itself.
std::string junit(const nlohmann::ordered_json& run_verdict);

}  // namespace lab
