#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "plant_sim/python/arrays.hpp"
#include "plant_sim/python/bindings.hpp"
#include "plant_sim/python/interruptible.hpp"
#include "plant_sim/study/torque_replay.hpp"
#include "rig_bridge/record/figure_fields.hpp"
#include "rig_bridge/record/ledger.hpp"
#include "rig_bridge/record/specimen.hpp"
#include "rig_bridge/replay/campaign_source.hpp"
#include "rig_bridge/wear/model_io.hpp"

namespace plant_sim::python {

using rig::record::LedgerRow;

namespace {

template <class T>
using Of = T (*)(const LedgerRow& row);

struct Field {
    const char* name;
    std::variant<Of<std::int64_t>, Of<double>, Of<bool>, Of<std::string>> of;
};

double known(const LedgerRow& row, double value) {
    return row.has_figures ? value : std::numeric_limits<double>::quiet_NaN();
}

using Words = std::vector<std::string>;

std::string joined(const Words& words, const char* apart = " ") {
    return fmt::format("{}", fmt::join(words, apart));
}

/// Before the figures; those and the specimen's fields have lists of their own.
const std::array<Field, 8> kHead{{
    {"number", [](const LedgerRow& r) { return r.attempt.number; }},
    {"attempt", [](const LedgerRow& r) { return r.attempt.attempt; }},
    {"state", [](const LedgerRow& r) { return std::string(name(r.state)); }},
    {"outcome", [](const LedgerRow& r) { return r.summary.outcome; }},
    {"started", [](const LedgerRow& r) { return r.summary.started; }},
    {"slip_reference", [](const LedgerRow& r) { return r.slip_reference; }},
    {"cumulative_energy_J", [](const LedgerRow& r) { return known(r, r.summary.cumulative_energy_J); }},
    {"counted_J", [](const LedgerRow& r) { return known(r, r.counted_J); }},
}};

/// After them.
const std::array<Field, 15> kTail{{
    {"standstill", [](const LedgerRow& r) { return r.has_figures && r.summary.figures.standstill; }},
    {"faults", [](const LedgerRow& r) { return joined(r.summary.faults); }},
    {"judged", [](const LedgerRow& r) { return r.summary.out_of_tolerance.has_value(); }},
    {"out_of_tolerance", [](const LedgerRow& r) { return joined(r.summary.out_of_tolerance.value_or(Words{})); }},
    {"warnings", [](const LedgerRow& r) { return joined(r.summary.warnings, "; "); }},
    {"health", [](const LedgerRow& r) { return std::string(name(r.health.state)); }},
    {"health_statistic", [](const LedgerRow& r) { return r.health.statistic; }},
    {"health_reason", [](const LedgerRow& r) { return r.health.reason; }},
    {"frames", [](const LedgerRow& r) { return static_cast<std::int64_t>(r.summary.frames); }},
    {"frames_dropped", [](const LedgerRow& r) { return static_cast<std::int64_t>(r.summary.frames_dropped); }},
    {"scenario", [](const LedgerRow& r) { return r.summary.scenario; }},
    {"seed", [](const LedgerRow& r) { return static_cast<std::int64_t>(r.summary.seed); }},
    {"version", [](const LedgerRow& r) { return r.summary.version; }},
    {"config_hash", [](const LedgerRow& r) { return r.summary.config_hash; }},
    {"folder", [](const LedgerRow& r) { return r.attempt.folder.string(); }},
}};

/// Of its cumulative energy, what the brake and disc of each row have taken.
std::vector<double> disc_energies_J(const std::vector<LedgerRow>& rows) {
    std::vector<double> energies_J;
    energies_J.reserve(rows.size());
    rig::record::DiscEnergy taken;
    for (const LedgerRow& row : rows)
        energies_J.push_back(row.has_figures ? taken.after(row.summary.specimen, row.summary.cumulative_energy_J) : known(row, 0.0));
    return energies_J;
}

/// A campaign's ledger; a bridge may write it at the same time.
class Ledger {
  public:
    /// `where`: the ledger or its directory. `campaign` empty: the only one. Throws settings::Error.
    Ledger(const std::filesystem::path& where, const std::string& campaign);

    [[nodiscard]] const std::string& campaign() const { return campaign_; }
    [[nodiscard]] const std::filesystem::path& file() const { return file_; }
    /// An array per column with one value for each attempt, oldest first.
    [[nodiscard]] py::dict rows() const;
    /// rows() as pandas.DataFrame; ImportError without pandas.
    [[nodiscard]] py::object data_frame() const;
    /// c_e and mean friction of all maneuvers that `rig-lab wear` uses.
    [[nodiscard]] py::tuple wear(bool out_of_tolerance) const;
    /// As `rig-lab wear simulate --replay torque` on the endurance rig, by a model.json: arrays of cumulative energy in J and of mean friction.
    /// Ctrl-C ends it. Throws settings::Error.
    [[nodiscard]] py::tuple simulated_wear(const py::dict& model, std::uint64_t seed, const Directory& config) const;
    /// c_e and worn share of the lining at each reading that `rig-lab wear` uses.
    [[nodiscard]] py::tuple lining() const;

  private:
    std::filesystem::path file_;
    std::string campaign_;
};

Ledger::Ledger(const std::filesystem::path& where, const std::string& campaign)
    : file_(rig::replay::ledger_at(where)), campaign_(rig::replay::chosen_campaign(file_, campaign)) {}

py::dict Ledger::rows() const {
    const std::vector<LedgerRow> rows = [&] {
        const py::gil_scoped_release others_run;
        return rig::record::read_ledger(file_, campaign_);
    }();
    py::dict out;
    const auto add = [&](const auto& fields) {
        for (const Field& field : fields) out[field.name] = std::visit([&](const auto of) { return column(rows, of); }, field.of);
    };
    add(kHead);
    for (const rig::record::FigureField& field : rig::record::kFigureFields)
        out[field.key] = column(rows, [&](const LedgerRow& row) { return known(row, row.summary.figures.*field.value); });
    out["disc_energy_J"] = column(disc_energies_J(rows));
    for (const rig::record::SpecimenField& field : rig::record::kSpecimenFields)
        out[field.key] = column(rows, [&](const LedgerRow& row) { return row.summary.specimen.*field.value; });
    for (const rig::record::WearReadingField& field : rig::record::kWearReadingFields)
        out[field.key] = column(rows, [&](const LedgerRow& row) { return row.worn.*field.value; });
    add(kTail);
    return out;
}

py::object Ledger::data_frame() const {
    py::module_ pandas;
    try {
        pandas = py::module_::import("pandas");
    } catch (py::error_already_set& e) {
        if (!e.matches(PyExc_ImportError)) throw;
        py::raise_from(e, PyExc_ImportError, "data_frame() needs pandas: install the Debian package python3-pandas");
        throw py::error_already_set();
    }
    return pandas.attr("DataFrame")(rows());
}

py::tuple Ledger::wear(bool out_of_tolerance) const {
    const wear::Campaign campaign = [&] {
        const py::gil_scoped_release others_run;
        using rig::replay::OutOfTolerance;
        return rig::replay::load_campaign(file_, campaign_, out_of_tolerance ? OutOfTolerance::taken : OutOfTolerance::left_out);
    }();
    return py::make_tuple(column(campaign.points, [](const wear::Point& p) { return p.c_e_J; }),
                          column(campaign.points, [](const wear::Point& p) { return p.mean_friction; }));
}

py::tuple Ledger::lining() const {
    const wear::Campaign campaign = [&] {
        const py::gil_scoped_release others_run;
        return rig::replay::wear_of(rig::record::read_ledger(file_, campaign_));
    }();
    return py::make_tuple(column(campaign.readings, [](const wear::LiningReading& r) { return r.c_e_J; }),
                          column(campaign.readings, [](const wear::LiningReading& r) { return r.worn; }));
}

py::tuple Ledger::simulated_wear(const py::dict& model, std::uint64_t seed, const Directory& config) const {
    const auto text = py::module_::import("json").attr("dumps")(model).cast<std::string>();
    std::atomic<bool> stop{false};
    const auto replay = [&] {
        const wear::Campaign recorded = rig::replay::load_campaign(file_, campaign_);
        rig::ManeuverChoice choice;
        choice.maneuver = rig::kEndurance;
        wear::BrakeWear brake;
        brake.model = std::make_shared<const wear::Model>(wear::from_json("model", text));
        brake.life_J = brake.model->data.last_c_e_J;
        // The seed as the verb takes it: draws that a campaign of the same seed did not make.
        const wear::BrakeState state{.seed = ~seed, .maneuvers = 0, .c_e_J = wear::taken_before_J(recorded)};
        return study::replay_torques(recorded, rig::load_rig(directory_of(config), choice), {brake, {}, state}, [&](std::size_t) {
            if (stop) throw std::runtime_error("stopped");
        });
    };
    const study::TorqueReplay replayed = interruptible(replay, [&] { stop = true; });
    return py::make_tuple(column(replayed.simulated.points, [](const wear::Point& p) { return p.c_e_J; }),
                          column(replayed.simulated.points, [](const wear::Point& p) { return p.mean_friction; }));
}

}  // namespace

void bind_ledger(py::module_& m) {
    py::class_<Ledger>(m, "Ledger")
        .def(py::init<const std::filesystem::path&, const std::string&>(), py::arg("where"), py::arg("campaign") = "")
        .def_property_readonly("campaign", &Ledger::campaign)
        .def_property_readonly("file", &Ledger::file)
        .def("rows", &Ledger::rows)
        .def("data_frame", &Ledger::data_frame)
        .def("wear", &Ledger::wear, py::kw_only(), py::arg("out_of_tolerance") = false)
        .def("lining", &Ledger::lining)
        .def("simulated_wear", &Ledger::simulated_wear, py::arg("model"), py::kw_only(), py::arg("seed") = 1, py::arg("config") = py::none());
}

}  // namespace plant_sim::python
