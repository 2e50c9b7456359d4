/// Identifies the worn parts of a maneuver: serial numbers, operator and notes. One list of fields for options, files, ledger and exports.
#pragma once

#include <array>
#include <map>
#include <string>
#include <utility>

namespace rig::record {

/// Empty fields are not specified.
struct Specimen {
    std::string brake{}, disc{}, tyre{}, specimen{};  ///< serial numbers
    std::string operator_name{};
    std::string notes{};
    bool operator==(const Specimen&) const = default;
};

struct SpecimenField {
    const char* key;    ///< in summary.json, the ledger and exports
    const char* label;  ///< for people
    const char* option;
    std::string Specimen::*value;
};

inline constexpr std::array kSpecimenFields{
    SpecimenField{"brake_serial", "brake", "--brake", &Specimen::brake},
    SpecimenField{"disc_serial", "disc", "--disc", &Specimen::disc},
    SpecimenField{"tyre_serial", "tyre", "--tyre", &Specimen::tyre},
    SpecimenField{"specimen_serial", "specimen", "--specimen", &Specimen::specimen},
    SpecimenField{"operator", "operator", "--operator", &Specimen::operator_name},
    SpecimenField{"notes", "notes", "--notes", &Specimen::notes},
};

/// UTF-8 of at most kLongestText bytes without control characters, so that it fits on one line everywhere. Throws std::invalid_argument that names
/// `what`.
inline constexpr std::size_t kLongestText = 1000;
void check_text(const std::string& what, const std::string& text);
void check_texts(const Specimen& specimen);

/// `said`, with empty fields taken from `before`.
[[nodiscard]] Specimen taken_over(Specimen said, const Specimen& before);

/// "brake B12, disc D7"; empty where nothing is known.
[[nodiscard]] std::string to_text(const Specimen& specimen);

/// Brake energy taken by each pair of brake and disc in a campaign: the energy of another disc is not its wear.
class DiscEnergy {
  public:
    /// Call per row, with the campaign's cumulative energy after it. Returns the energy of this row's brake and disc so far, J.
    double after(const Specimen& specimen, double cumulative_J) {
        double& taken_J = taken_J_[{specimen.brake, specimen.disc}];
        taken_J += cumulative_J - before_J_;
        before_J_ = cumulative_J;
        return taken_J;
    }

  private:
    std::map<std::pair<std::string, std::string>, double> taken_J_;
    double before_J_ = 0.0;
};

}  // namespace rig::record
