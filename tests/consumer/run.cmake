# run(<command>...): stops with all that the command said when it fails; `said` has it otherwise.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(failed)
    string(REPLACE ";" " " command "${ARGN}")
    message(FATAL_ERROR "${command}\nfailed:\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()
