# SPDX-License-Identifier: GPL-3.0-or-later
execute_process(COMMAND ${PROGRAM} ${ARGUMENT} OUTPUT_VARIABLE computed RESULT_VARIABLE status)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "paper_page ended with ${status}")
endif()
file(READ ${PAGE} page)
if(NOT computed STREQUAL page)
  message(FATAL_ERROR "${PAGE} is stale; write it anew: ${PROGRAM} ${ARGUMENT} > ${PAGE}")
endif()
