/// The specimen on a command line: an option for each of its fields.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

#include "rig_bridge/record/specimen.hpp"

namespace rig::record {

/// `since`: what follows in each option's help. `specimen` must outlive the parse; check_texts() is the caller's.
inline void add_specimen_options(CLI::App& app, Specimen& specimen, const std::string& since) {
    for (const SpecimenField& field : kSpecimenFields) {
        const bool serial = field.value != &Specimen::operator_name && field.value != &Specimen::notes;
        app.add_option(field.option, specimen.*field.value,
                       (serial ? std::string("serial number of the ") + field.label : std::string(field.label)) + since)
            ->type_name("TEXT");
    }
}

}  // namespace rig::record
