/// Measurements of an endurance campaign: mean brake friction over the energy taken by the brake, one point per maneuver (the paper's Fig. 7).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/host/settings/error.hpp"
#include "rig_bridge/wear/provenance.hpp"

namespace wear {

/// x of eq. (12).
struct Point {
    double c_e_J = 0.0;          ///< cumulative brake energy, this maneuver included, eq. (9)
    double mean_friction = 0.0;  ///< mean mu_b of the maneuver, eq. (7)
    bool operator==(const Point&) const = default;
};

/// How far the lining is worn, read after a maneuver by wear pin or gauge.
struct LiningReading {
    double c_e_J = 0.0;  ///< of the brake when it was read
    double worn = 0.0;   ///< share of what may wear: 0 new, 1 at its limit; the reading's error may bring it outside
    bool operator==(const LiningReading&) const = default;
    static constexpr double kMin = -0.1, kMax = 1.2;  ///< plausible
};

/// Further data of a maneuver, to reproduce it.
struct Braking {
    double brake_on_mps = 0.0;    ///< rim speed at brake-on
    double mean_torque_Nm = 0.0;  ///< of the brake, from brake-on to standstill
    double mean_load_N = 0.0;     ///< F_z, likewise
    bool operator==(const Braking&) const = default;
};

/// A landing that finished, also one that is no point.
struct LandingEnergy {
    double c_e_J = 0.0;     ///< cumulative, this landing included
    double energy_J = 0.0;  ///< of this landing alone, > 0
    bool operator==(const LandingEnergy&) const = default;
};

struct Campaign {
    std::string source;                     ///< where it was read, for people
    std::vector<Point> points;              ///< in the order of the maneuvers
    std::vector<Braking> brakings{};        ///< one per point if recorded, else empty
    std::string brake{}, disc{};            ///< serial numbers; empty: not known
    std::string origin = kUnknownOrigin;    ///< provenance.hpp
    std::vector<LiningReading> readings{};  ///< in the order of their energy; none: nobody read it
    std::vector<LandingEnergy> landings{};  ///< rising; of a point that has none the energy is that since the point before
    double taken_J = 0.0;                   ///< by the brake until now, if more than at the newest point: of maneuvers after it that are no points
    bool operator==(const Campaign&) const = default;
};

/// CSV with a header. Columns, in any order, others are passed over: `cumulative_energy_MJ` or `cumulative_energy_J` (one of them), and
/// `mean_friction`. Where there are `brake_on_mps`, `mean_torque_Nm` and `mean_load_N`, all three and positive, too. Where there are `brake_serial`
/// and `disc_serial`, each the same in all rows: wear of two discs is no campaign. `lining_worn` is a LiningReading after the maneuver, within -0.1
/// to 1.2, and empty where there is none. Where there is `outcome`, only rows with `finished` that add energy are maneuvers; the others add their
/// energy and readings, and their number stands in the source, but for those of `left_out`; one that is `out_of_tolerance` is a landing.
/// `brake_energy_J` is the energy of that landing alone, no more than the cumulative energy rises by; where it is empty or missing, it is what the
/// cumulative energy rises by. Empty lines and lines that begin with # are passed over, but for `# origin: measured on rig 7` or `# origin: made up
/// by ...`, which says where the campaign is from. At least two maneuvers; energy positive and strictly increasing by at most 1e9 J a maneuver and by
/// at least 100 J on average; friction within 0.001 to 1.5, and not the same everywhere. Throws settings::Error with `name` and the line of what is
/// wrong otherwise. `name` becomes the source.
[[nodiscard]] Campaign parse_campaign(const std::string& name, std::string_view csv);

/// The same from a file.
[[nodiscard]] Campaign read_campaign(const std::filesystem::path& csv);

/// The same checks for points from another source; errors name row i as line `first_line` + i of `campaign.source`.
void check(const Campaign& campaign, unsigned first_line = 1);

/// CSV that read_campaign() reads back to the last bit. Columns: the origin where it is known, maneuver,mean_friction,brake_energy_J,
/// cumulative_energy_J, the brakings and readings where there are some, and the serial numbers where they are known. The first maneuver's brake
/// energy is left empty where energy was counted before it. A landing that is no point, a reading that was not made after a point (in a ledger after
/// an aborted maneuver) and energy taken after the newest point have rows of their own, and the last column is then `outcome`: `finished`,
/// `out_of_tolerance` or `left_out`.
[[nodiscard]] std::string to_csv(const Campaign& campaign);

/// Hash of points and readings alone, independent of their source and other data.
[[nodiscard]] std::string data_hash(const Campaign& campaign);

/// Energy taken by the brake before the first maneuver, J: 0 for a new one (see brake_energy_J()); where that is unknown, the energy after it minus a
/// mean maneuver.
[[nodiscard]] double taken_before_J(const Campaign& campaign);

/// Energy taken by the brake until now, J: after the newest point, or after what came later. The campaign has a point.
[[nodiscard]] double taken_now_J(const Campaign& campaign);

/// Energy of maneuver `i`, J: of its landing, else since the point before. For the first it is then the cumulative energy if that is at most 1.5
/// times the mean of the others (a new brake), else NaN.
[[nodiscard]] double brake_energy_J(const Campaign& campaign, std::size_t i);

}  // namespace wear
