/* An agent without a C library that is loaded at its start: it says hello and is done. */
#include <stdio.h>
#include <stdlib.h>

int main(void) {
    char *line = NULL;
    size_t size = 0;
    puts("{\"hello\": {\"protocol\": 1, \"name\": \"plain\", \"version\": \"1.0\"}}");
    fflush(stdout);
    if (getline(&line, &size, stdin) < 0)
        return 3;
    free(line);
    puts("{\"done\": {}}");
    fflush(stdout);
    return 0;
}
