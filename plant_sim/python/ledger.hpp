/// A campaign's ledger as Python reads it; a bridge may be writing it meanwhile.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>

namespace plant_sim::python {

class Ledger {
  public:
    /// `where`: the ledger or its directory. `campaign`: empty for the only one. Throws settings::Error.
    Ledger(const std::filesystem::path& where, const std::string& campaign);

    [[nodiscard]] const std::string& campaign() const { return campaign_; }
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }
    /// An array of each column, a value for each attempt, oldest first.
    [[nodiscard]] pybind11::dict rows() const;
    /// Of rows(); ImportError where there is no pandas.
    [[nodiscard]] pybind11::object data_frame() const;
    /// c_e and mean friction of every maneuver that `rig-lab wear` would learn from.
    [[nodiscard]] pybind11::tuple wear(bool out_of_tolerance) const;

  private:
    std::filesystem::path file_;
    std::string campaign_;
};

}  // namespace plant_sim::python
