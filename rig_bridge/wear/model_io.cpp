#include "rig_bridge/wear/model_io.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "firmware/host/settings/input_file.hpp"
#include "firmware/host/settings/near_miss.hpp"

namespace wear {

namespace {

using settings::Json;
using Reader = settings::JsonObject;

Model::Data data_of(Reader r, bool says_origin) {
    Model::Data d;
    d.source = r.text("source");
    d.hash = r.text("hash");
    d.maneuvers = r.count("maneuvers", 2);
    d.first_c_e_J = r.positive("first_cumulative_energy_J");
    d.last_c_e_J = r.positive("last_cumulative_energy_J");
    d.min_friction = r.positive("min_mean_friction");
    d.greatest_friction = r.positive("greatest_mean_friction");
    if (says_origin) d.origin = origin_in(r);
    r.finish();
    if (d.last_c_e_J <= d.first_c_e_J) r.fail("last_cumulative_energy_J", "must be above the first");
    return d;
}

Model::Search search_of(Reader r) {
    Model::Search s;
    s.seed = r.count("seed");
    s.starts = static_cast<int>(r.count("starts", 1));
    s.tolerance = r.positive("tolerance");
    s.covariance_floor = r.positive("covariance_floor");
    r.finish();
    return s;
}

Model::Candidate order_of(Reader r) {
    Model::Candidate o{.components = r.count("components", 1), .log_likelihood = r.number("log_likelihood"), .bic = r.number("bic")};
    if (r.has("score")) o.score = r.number("score");
    r.finish();
    return o;
}

Component component_of(Reader r) {
    const Component c{r.positive("weight"),      r.number("mean_cumulative_energy_J"),
                      r.number("mean_friction"), r.positive("variance_cumulative_energy_J2"),
                      r.number("covariance_J"),  r.positive("variance_friction")};
    r.finish();
    return c;
}

Json json_of(const Component& c) {
    return {{"weight", c.weight},
            {"mean_cumulative_energy_J", c.mean_c_e_J},
            {"mean_friction", c.mean_friction},
            {"variance_cumulative_energy_J2", c.variance_c_e_J2},
            {"covariance_J", c.covariance_J},
            {"variance_friction", c.variance_friction}};
}

}  // namespace

std::string origin_in(settings::JsonObject& r) {
    const std::string text = r.text("origin");
    if (!is_origin(text)) r.fail("origin", "must begin with 'measured' or 'made up', or be 'unknown origin'");
    return settings::printable(text);
}

Json json_of(const Provenance& p) {
    return {{"origin", p.origin}, {"lives", p.lives}};
}

std::string to_json(const Model& m) {
    Json orders = Json::array();
    for (const Model::Candidate& o : m.orders) {
        orders.push_back({{"components", o.components}, {"log_likelihood", o.log_likelihood}, {"bic", o.bic}});
        if (o.score) orders.back()["score"] = *o.score;
    }
    Json components = Json::array();
    for (const Component& c : m.mixture.components()) components.push_back(json_of(c));
    const Json json{
        {"format", kModelFormat},
        {"format_version", kModelFormatVersion},
        {"data",
         {{"source", m.data.source},
          {"hash", m.data.hash},
          {"maneuvers", m.data.maneuvers},
          {"first_cumulative_energy_J", m.data.first_c_e_J},
          {"last_cumulative_energy_J", m.data.last_c_e_J},
          {"min_mean_friction", m.data.min_friction},
          {"greatest_mean_friction", m.data.greatest_friction},
          {"origin", m.data.origin}}},
        {"search",
         {{"seed", m.search.seed}, {"starts", m.search.starts}, {"tolerance", m.search.tolerance}, {"covariance_floor", m.search.covariance_floor}}},
        {"orders", orders},
        {"components", components}};
    // A path need not be UTF-8; JSON must.
    return settings::json_page(json);
}

Model from_json(const std::string& name, std::string_view text) {
    const Json json = settings::parsed_json(name, text);
    Reader root(name, "", json);
    const bool says_origin = root.check_format(kModelFormat, kModelFormatVersion, 1) > 1;
    const Model::Data data = data_of(root.object("data"), says_origin);
    const Model::Search search = search_of(root.object("search"));
    std::vector<Model::Candidate> orders;
    for (const Reader& r : root.objects("orders")) orders.push_back(order_of(r));
    std::vector<Component> components;
    for (const Reader& r : root.objects("components")) components.push_back(component_of(r));
    root.finish();
    try {
        return {data, search, orders, Mixture(components)};
    } catch (const std::invalid_argument& e) {
        root.fail("components", e.what());
    }
}

Model read_model(const std::filesystem::path& json) {
    return from_json(json.string(), settings::read_file(json));
}

}  // namespace wear
