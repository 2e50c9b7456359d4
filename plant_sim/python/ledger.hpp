/// A campaign's ledger for Python; a bridge may write it at the same time.
#pragma once

#include <pybind11/pybind11.h>

#include <filesystem>
#include <string>

namespace plant_sim::python {

class Ledger {
  public:
    /// `where`: the ledger or its directory. `campaign` empty: the only one. Throws settings::Error.
    Ledger(const std::filesystem::path& where, const std::string& campaign);

    [[nodiscard]] const std::string& campaign() const { return campaign_; }
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }
    /// An array per column with one value for each attempt, oldest first.
    [[nodiscard]] pybind11::dict rows() const;
    /// rows() as pandas.DataFrame; ImportError without pandas.
    [[nodiscard]] pybind11::object data_frame() const;
    /// c_e and mean friction of all maneuvers that `rig-lab wear` uses.
    [[nodiscard]] pybind11::tuple wear(bool out_of_tolerance) const;
    /// c_e and worn share of the lining at each reading that `rig-lab wear` uses.
    [[nodiscard]] pybind11::tuple lining() const;

  private:
    std::filesystem::path file_;
    std::string campaign_;
};

}  // namespace plant_sim::python
