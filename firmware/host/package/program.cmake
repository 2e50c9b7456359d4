find_program(HELP2MAN help2man)
find_program(GZIP gzip)
# Programs run to make them: not with every build.
add_custom_target(man_pages)

# program(NAME COMPONENT): one that people start, in build/PRESET/bin, and in the Debian package of that component with its manual page and
# completion.
function(program name component)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)
    install(TARGETS ${name} RUNTIME COMPONENT ${component})
    set(package ${PROJECT_SOURCE_DIR}/firmware/host/package)
    install(FILES ${package}/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions RENAME ${name}
        COMPONENT ${component})
    if(HELP2MAN AND GZIP)
        set(page ${CMAKE_CURRENT_BINARY_DIR}/${name}.1.gz)
        add_custom_command(OUTPUT ${page}
            COMMAND ${CMAKE_COMMAND} -E env LC_ALL=C ${package}/man_page ${HELP2MAN} $<TARGET_FILE:${name}> ${PROJECT_VERSION} ${page}
            DEPENDS ${name} ${package}/man_page VERBATIM)
        add_custom_target(man_page_of_${name} DEPENDS ${page})
        add_dependencies(man_pages man_page_of_${name})
        install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
    endif()
endfunction()
