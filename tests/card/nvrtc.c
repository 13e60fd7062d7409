/* The C compiler in the place of NVRTC: the "PTX" of a source is the path of a shared library, written to the folder
 * CARD_FOLDER. A kernel NAME gets a function NAME_with, which takes the addresses of its arguments. */

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef int Result;
enum { SUCCESS = 0, COMPILATION = 6 };

#define KERNEL "_KERNEL void "

typedef struct {
    char *source;
    char path[512];
} Program;

Result nvrtcCreateProgram(Program **program, const char *source, const char *name, int count, const char *const *headers,
                          const char *const *names) {
    (void)name, (void)count, (void)headers, (void)names;
    *program = calloc(1, sizeof **program);
    (*program)->source = strdup(source);
    return SUCCESS;
}

/* Writes NAME_with for a kernel, at whose name `text` is. */
static void with(FILE *file, const char *text) {
    int name = (int)strcspn(text, "("), argument = 0;
    const char *at = text + name + 1;
    fprintf(file, "void %.*s_with(void **a) {\n    %.*s(", name, text, name, text);
    while (*at && *at != ')') {
        /* A type, then the name of the argument. */
        int length = (int)strcspn(at, ",)"), type = length;
        while (type > 0 && strchr(" \n", at[type - 1])) {
            type--;
        }
        while (type > 0 && !strchr(" *", at[type - 1])) {
            type--;
        }
        fprintf(file, "%s*(%.*s *)a[%d]", argument ? ", " : "", type, at, argument);
        argument++;
        at += length + (at[length] == ',');
    }
    fprintf(file, ");\n}\n");
}

Result nvrtcCompileProgram(Program *program, int count, const char *const *options) {
    static int number;
    char command[2048];
    const char *folder = getenv("CARD_FOLDER");
    const char *kernel;
    FILE *file;
    (void)count, (void)options;
    snprintf(program->path, sizeof program->path, "%s/kernel_%d_%d.so", folder ? folder : ".", (int)getpid(), number++);
    snprintf(command, sizeof command, "cc -x c -std=c99 -O2 -ffp-contract=off -Wall -Wextra -Werror -shared -fPIC -o '%s' - -lm",
             program->path);
    file = popen(command, "w");
    if (!file) {
        return COMPILATION;
    }
    fputs(program->source, file);
    for (kernel = strstr(program->source, KERNEL); kernel; kernel = strstr(kernel, KERNEL)) {
        kernel += strlen(KERNEL);
        with(file, kernel);
    }
    return pclose(file) ? COMPILATION : SUCCESS;
}

Result nvrtcGetPTXSize(Program *program, size_t *size) {
    *size = strlen(program->path) + 1;
    return SUCCESS;
}

Result nvrtcGetPTX(Program *program, char *text) {
    strcpy(text, program->path);
    return SUCCESS;
}

Result nvrtcGetCUBINSize(Program *program, size_t *size) {
    return nvrtcGetPTXSize(program, size);
}

Result nvrtcGetCUBIN(Program *program, char *code) {
    return nvrtcGetPTX(program, code);
}

Result nvrtcGetProgramLogSize(Program *program, size_t *size) {
    (void)program;
    *size = sizeof "the C compiler refuses the source";
    return SUCCESS;
}

Result nvrtcGetProgramLog(Program *program, char *text) {
    (void)program;
    strcpy(text, "the C compiler refuses the source");
    return SUCCESS;
}

Result nvrtcDestroyProgram(Program **program) {
    free((*program)->source);
    free(*program);
    return SUCCESS;
}
