/// Campaigns of a made-up fleet as CSV, to learn a population from and to test a forecast on: wear-fleet FIRST_SEED COUNT DIR; or of brakes
/// as the virtual rig draws them from a model: wear-fleet FIRST_SEED COUNT DIR MODEL nearest|mixture.
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <string_view>

#include "firmware/host/settings/atomic_file.hpp"
#include "rig_bridge/wear/model_io.hpp"
#include "rig_bridge/wear/wearing_brake.hpp"
#include "tests/wear/fleet.hpp"

namespace {

wear::Campaign drawn(const std::shared_ptr<const wear::Model>& model, wear::Choice choice, std::uint64_t seed) {
    wear::WearingBrake brake({model, {}, model->data.last_c_e_J, {}}, {wear::Variance::exact, choice}, {seed, 0, 0.0});
    wear::Campaign campaign;
    campaign.origin = "made up by drawing from " + model->data.source;
    for (std::size_t i = 0; i < model->data.maneuvers; ++i) {
        const double friction = brake.next_friction();
        brake.take(model->data.mean_step_J());
        campaign.points.push_back({brake.state().c_e_J, friction});
    }
    return campaign;
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 4 && argc != 6) {
        fmt::print(stderr, "wear-fleet FIRST_SEED COUNT DIR [MODEL nearest|mixture]\n");
        return 2;
    }
    const std::uint64_t first = std::stoull(argv[1]);
    const std::uint64_t count = std::stoull(argv[2]);
    const std::filesystem::path directory = argv[3];
    std::filesystem::create_directories(directory);
    std::shared_ptr<const wear::Model> model;
    if (argc == 6) model = std::make_shared<const wear::Model>(wear::read_model(argv[4]));
    const wear::Choice choice = argc == 6 && std::string_view(argv[5]) == "mixture" ? wear::Choice::mixture : wear::Choice::nearest;
    for (std::uint64_t seed = first; seed < first + count; ++seed)
        settings::write_file(directory / fmt::format("brake_{:06}.csv", seed),
                             wear::to_csv(model ? drawn(model, choice, seed) : physical::worn_out(seed).campaign));
    return 0;
} catch (const std::exception& e) {
    fmt::print(stderr, "wear-fleet: {}\n", e.what());
    return 1;
}
