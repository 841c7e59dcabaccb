/* Gives a plain LCM program in C a name, and tells lcmtools what it publishes and listens to, so that
 * lcmtools list, info, node list, wtf and graph know it. C99 with POSIX; the same for C++ is in
 * lcmtools/announcer.hpp. Include it in one source file, and link with -llcm -pthread.
 *
 *     lcm_t *lcm = lcm_create(NULL);
 *     lcmtools_announcer *announcer = lcmtools_announcer_create(lcm, "lidar_driver", NULL);
 *     lcmtools_publishes(announcer, "SCAN", LCMTOOLS_TYPE(sensors, scan_t));
 *     lcmtools_subscribes(announcer, "CMD", LCMTOOLS_TYPE(robots, cmd_t));
 *     ...
 *     lcmtools_announcer_destroy(announcer);
 *     lcm_destroy(lcm);
 *
 * A thread announces the program once a second on its own lcm_t (docs/protocol.md). Requests of
 * lcmtools are handled by the program's lcm_handle; a program that only publishes does not call that, and
 * is announced four times a second instead, and lcmtools node kill does not reach it. It is announced
 * as ended by lcmtools_announcer_destroy, exit, and SIGINT, SIGTERM, SIGHUP and SIGPIPE unless the program
 * had a handler of its own for them when the announcer was made.
 */
#ifndef LCMTOOLS_H
#define LCMTOOLS_H

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <lcm/lcm.h>

/* A type of lcm-gen's C code, by its package and name. */
#define LCMTOOLS_TYPE(package, name) #package "/" #name, __##package##_##name##_hash_recursive(NULL)
/* One without a package. */
#define LCMTOOLS_PLAIN_TYPE(name) #name, __##name##_hash_recursive(NULL)

typedef struct lcmtools_buffer {
    char *data;
    size_t size;
} lcmtools_buffer;

typedef struct lcmtools_announcer {
    lcm_t *lcm;
    char name[64], id[33], host[256], command[1001];
    char folder[512]; /* of the records of running nodes */
    int64_t start_time;
    int wakeup[2]; /* a pipe: 'w' to announce a change, else the number of a signal */
    pthread_t thread;
    pthread_mutex_t mutex;     /* of all that follows */
    lcmtools_buffer endpoints; /* encoded */
    int number_of_endpoints, is_listening, is_over, is_asked_to_end;
    lcmtools_buffer topics[2]; /* published and subscribed to, as JSON */
    int64_t nonce;             /* of the request to be answered */
    lcm_subscription_t *requests[2];
    struct lcmtools_announcer *next;
} lcmtools_announcer;

static lcmtools_announcer *lcmtools_announcers = NULL; /* all of the program */
static pthread_mutex_t lcmtools_mutex = PTHREAD_MUTEX_INITIALIZER;
static volatile sig_atomic_t lcmtools_wakeup = -1; /* where the signal handler writes */

/* ---- LCM's encoding: big-endian numbers, strings with their length and a zero byte. ---- */

static inline void lcmtools_put_bytes(lcmtools_buffer *buffer, const void *bytes, size_t size)
{
    char *data = (char *) realloc(buffer->data, buffer->size + size + 1);
    if (data == NULL) abort();
    if (size > 0) memcpy(data + buffer->size, bytes, size);
    buffer->data = data;
    buffer->size += size;
    data[buffer->size] = '\0';
}

static inline void lcmtools_put(lcmtools_buffer *buffer, int64_t value, int size)
{
    for (int i = size - 1; i >= 0; --i) {
        char byte = (char) (uint8_t) ((uint64_t) value >> (8 * i));
        lcmtools_put_bytes(buffer, &byte, 1);
    }
}

static inline void lcmtools_put_text(lcmtools_buffer *buffer, const char *text)
{
    lcmtools_put(buffer, (int64_t) strlen(text) + 1, 4);
    lcmtools_put_bytes(buffer, text, strlen(text) + 1);
}

static inline int64_t lcmtools_get(const uint8_t *data, int size)
{
    uint64_t value = 0;
    for (int i = 0; i < size; ++i) value = value << 8 | data[i];
    return (int64_t) value;
}

/* Return whether a message is a request of this type for this target, and its nonce. */
static inline int lcmtools_is_request(const lcm_recv_buf_t *buffer, uint64_t type, const char *target, int64_t *nonce)
{
    const uint8_t *data = (const uint8_t *) buffer->data;
    if (buffer->data_size < 21 || (uint64_t) lcmtools_get(data, 8) != type) return 0;
    int64_t length = lcmtools_get(data + 8, 4);
    if (length < 1 || length > (int64_t) buffer->data_size - 20) return 0;
    *nonce = lcmtools_get(data + 12 + length, 8);
    return (size_t) length == strlen(target) + 1 && memcmp(data + 12, target, (size_t) length) == 0;
}

/* ---- The record, by which a killed program is noticed. ---- */

static inline void lcmtools_put_json(lcmtools_buffer *buffer, const char *text)
{
    lcmtools_put_bytes(buffer, "\"", 1);
    for (; *text; ++text) {
        char code[8];
        snprintf(code, sizeof code, "\\u%04x", (unsigned char) *text);
        if ((unsigned char) *text < 0x20 || *text == '"' || *text == '\\') lcmtools_put_bytes(buffer, code, 6);
        else lcmtools_put_bytes(buffer, text, 1);
    }
    lcmtools_put_bytes(buffer, "\"", 1);
}

static inline int64_t lcmtools_namespace(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 ? (int64_t) status.st_ino : 0;
}

/* Return the start of this process [clock ticks since boot]; 0 if it is unknown. */
static inline unsigned long long lcmtools_start_ticks(void)
{
    char text[1024] = "";
    FILE *file = fopen("/proc/self/stat", "r");
    if (file == NULL) return 0;
    size_t size = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[size] = '\0';
    const char *at = strrchr(text, ')');
    for (int field = 2; field < 22 && at != NULL; ++field) at = strchr(at + 1, ' ');
    return at ? strtoull(at, NULL, 10) : 0;
}

/* Return a number of the process's network namespace, which no later one gets; 0 if unknown. */
static inline unsigned long long lcmtools_network_cookie(void)
{
    uint64_t cookie = 0;
    socklen_t size = sizeof cookie;
    int one = socket(AF_INET, SOCK_DGRAM, 0);
    /* SO_NETNS_COOKIE of asm-generic/socket.h, since Linux 5.14 */
    if (one < 0 || getsockopt(one, SOL_SOCKET, 71, &cookie, &size) != 0) cookie = 0;
    if (one >= 0) close(one);
    return cookie;
}

/* Make the folder of a bus's records, which no other user can write into; return whether it is there. */
static inline int lcmtools_make_folder(char *folder, size_t room, const char *url)
{
    const char *runtime = getenv("XDG_RUNTIME_DIR");
    char base[256], provider[16] = "udpm", network[128] = "";
    struct stat inner, outer;
    if (url == NULL || *url == '\0') url = getenv("LCM_DEFAULT_URL");
    if (url == NULL || *url == '\0') url = "udpm://";
    if (sscanf(url, "%15[^:]://%127[^?]", provider, network) < 1) return 0;
    int is_server = strcmp(provider, "tcpq") == 0, is_group = strcmp(provider, "udpm") == 0 || strcmp(provider, "mpudpm") == 0;
    char *port = strchr(network, ':');
    if (port) *port++ = '\0';
    if (!is_server && !is_group) *network = '\0';
    if (runtime && stat(runtime, &outer) == 0) snprintf(base, sizeof base, "%s/lcmtools", runtime);
    else snprintf(base, sizeof base, "/tmp/lcmtools-%u", (unsigned) getuid());
    mkdir(base, 0700);
    snprintf(folder, room, "%s/records", base);
    mkdir(folder, 0700);
    snprintf(folder, room, "%s/records/%s-%s-%s", base, provider,
             *network ? network : is_server ? "127.0.0.1" : is_group ? "239.255.76.67" : "",
             port && *port ? port : is_server ? "7700" : is_group ? "7667" : "0");
    mkdir(folder, 0700);
    return lstat(folder, &inner) == 0 && lstat(base, &outer) == 0 && S_ISDIR(inner.st_mode) && inner.st_uid == getuid() &&
           outer.st_uid == getuid() && !(outer.st_mode & (S_IWGRP | S_IWOTH));
}

/* Add a channel that is published (role 0) or subscribed to (1). */
static inline void lcmtools_add_topic(lcmtools_announcer *self, const char *channel, int role)
{
    if (self->topics[role].size > 0) lcmtools_put_bytes(&self->topics[role], ", ", 2);
    lcmtools_put_json(&self->topics[role], channel);
}

static inline void lcmtools_write_record(lcmtools_announcer *self)
{
    char path[600], temporary[600], numbers[500];
    lcmtools_buffer json = {NULL, 0};
    const char *texts[] = {"{\"version\": 2, \"name\": ", self->name, ", \"id\": ", self->id,
                           ", \"host\": ", self->host, ", \"command\": ", self->command};
    for (int i = 0; i < 8; i += 2) {
        lcmtools_put_bytes(&json, texts[i], strlen(texts[i]));
        lcmtools_put_json(&json, texts[i + 1]);
    }
    snprintf(numbers, sizeof numbers,
             ", \"pid\": %d, \"start_time\": %" PRId64 ", \"start_ticks\": %llu, \"network\": %" PRId64
             ", \"network_cookie\": %llu, \"pid_namespace\": %" PRId64,
             (int) getpid(), self->start_time, lcmtools_start_ticks(), lcmtools_namespace("/proc/self/ns/net"),
             lcmtools_network_cookie(), lcmtools_namespace("/proc/self/ns/pid"));
    snprintf(path, sizeof path, "%s/%s.json", self->folder, self->id);
    snprintf(temporary, sizeof temporary, "%s/.%s", self->folder, self->id);
    FILE *file = fopen(temporary, "w");
    if (file) {
        fprintf(file, "%s%s, \"publishes\": [%s], \"subscribes\": [%s]}", json.data, numbers,
                self->topics[0].data ? self->topics[0].data : "", self->topics[1].data ? self->topics[1].data : "");
        if (fclose(file) != 0 || rename(temporary, path) != 0) remove(temporary);
    }
    free(json.data);
}

/* ---- Announcements. The mutex is held. ---- */

static inline int64_t lcmtools_now(void)
{
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (int64_t) now.tv_sec * 1000000000 + now.tv_nsec;
}

static inline void lcmtools_announce(lcmtools_announcer *self, int is_leaving)
{
    lcmtools_buffer details = {NULL, 0}, message = {NULL, 0};
    lcmtools_put(&details, 0, 4); /* other ports */
    lcmtools_put(&details, self->number_of_endpoints, 4);
    lcmtools_put(&details, 0, 4); /* errors of callbacks */
    lcmtools_put_bytes(&details, self->endpoints.data, self->endpoints.size);
    lcmtools_put(&details, 0, 8); /* time in callbacks */
    lcmtools_put(&details, lcmtools_namespace("/proc/self/ns/pid"), 8);
    lcmtools_put(&details, 0, 8); /* lost datagrams */
    uint64_t revision = 0xcbf29ce484222325; /* FNV-1a */
    for (size_t i = 0; i < details.size; ++i) revision = (revision ^ (uint8_t) details.data[i]) * 0x100000001b3;

    lcmtools_put(&message, 0x04FC851A704B5456, 8);
    lcmtools_put(&message, (int64_t) details.size, 4);
    lcmtools_put(&message, 2, 4); /* version of the protocol */
    lcmtools_put_text(&message, self->name);
    lcmtools_put_text(&message, self->host);
    lcmtools_put(&message, getpid(), 4);
    lcmtools_put(&message, self->start_time, 8);
    lcmtools_put_text(&message, self->id);
    lcmtools_put(&message, is_leaving, 1);
    lcmtools_put(&message, (int64_t) revision, 8);
    lcmtools_put(&message, 0, 1); /* not a tool */
    lcmtools_put_text(&message, self->command);
    lcmtools_put_text(&message, "lcmtools C 0.1.0");
    lcmtools_put(&message, self->nonce, 8);
    lcmtools_put(&message, lcmtools_now(), 8);
    lcmtools_put_bytes(&message, details.data, details.size);
    lcm_publish(self->lcm, "/_lcmtools/node", message.data, (unsigned) message.size);
    self->nonce = 0;
    free(details.data);
    free(message.data);
}

static inline void lcmtools_remove_record(const char *folder, const char *id)
{
    char path[600];
    snprintf(path, sizeof path, "%s/%s.json", folder, id);
    remove(path);
}

static inline void lcmtools_say_goodbye(lcmtools_announcer *self)
{
    pthread_mutex_lock(&self->mutex);
    if (!self->is_over) lcmtools_announce(self, 1);
    self->is_over = 1;
    lcmtools_remove_record(self->folder, self->id);
    pthread_mutex_unlock(&self->mutex);
}

static inline void lcmtools_say_all_goodbyes(void)
{
    pthread_mutex_lock(&lcmtools_mutex);
    for (lcmtools_announcer *one = lcmtools_announcers; one; one = one->next) lcmtools_say_goodbye(one);
    pthread_mutex_unlock(&lcmtools_mutex);
}

static inline void lcmtools_wake(lcmtools_announcer *self, char reason)
{
    if (write(self->wakeup[1], &reason, 1) < 0) return; /* it is full: the thread will wake anyway */
}

static inline void lcmtools_on_signal(int number)
{
    int error = errno, wakeup = lcmtools_wakeup;
    char reason = (char) number;
    if (wakeup < 0 || write(wakeup, &reason, 1) < 0) signal(number, SIG_DFL); /* for the next one */
    errno = error;
}

static inline void *lcmtools_run(void *argument)
{
    lcmtools_announcer *self = (lcmtools_announcer *) argument;
    struct pollfd wait = {self->wakeup[0], POLLIN, 0};
    int period_ms = 0, spread_ms = (int) (self->start_time / 1000 % 10);
    for (;;) {
        char reasons[64];
        if (poll(&wait, 1, period_ms) > 0) poll(NULL, 0, spread_ms); /* so that many requests get one answer */
        ssize_t count = read(self->wakeup[0], reasons, sizeof reasons);
        for (ssize_t i = 0; i < count; ++i) {
            if (reasons[i] == 'w') continue;
            lcmtools_say_all_goodbyes();
            signal(reasons[i], SIG_DFL);
            kill(getpid(), reasons[i]);
        }
        pthread_mutex_lock(&self->mutex);
        int is_over = self->is_over, ends = self->is_asked_to_end;
        self->is_asked_to_end = 0;
        period_ms = self->is_listening ? 1000 : 250;
        if (!is_over) lcmtools_announce(self, 0);
        pthread_mutex_unlock(&self->mutex);
        if (is_over) return NULL;
        if (ends) {
            fprintf(stderr, "%s: shutdown requested over the bus\n", self->name);
            kill(getpid(), SIGTERM);
        }
    }
}

/* Have the thread answer a request. */
static inline void lcmtools_answer(lcmtools_announcer *self, int64_t nonce, int is_asked_to_end)
{
    pthread_mutex_lock(&self->mutex);
    self->nonce = nonce;
    self->is_asked_to_end |= is_asked_to_end;
    pthread_mutex_unlock(&self->mutex);
    lcmtools_wake(self, 'w');
}

static inline void lcmtools_on_probe(const lcm_recv_buf_t *buffer, const char *channel, void *user)
{
    lcmtools_announcer *self = (lcmtools_announcer *) user;
    const uint64_t type = 0x36A8CC66FEBE4DC8;
    int64_t nonce;
    (void) channel;
    if (lcmtools_is_request(buffer, type, "", &nonce) || lcmtools_is_request(buffer, type, self->name, &nonce))
        lcmtools_answer(self, nonce, 0);
}

static inline void lcmtools_on_shutdown(const lcm_recv_buf_t *buffer, const char *channel, void *user)
{
    lcmtools_announcer *self = (lcmtools_announcer *) user;
    int64_t nonce;
    (void) channel;
    if (lcmtools_is_request(buffer, 0x2E46E88DD1CD3B5F, self->id, &nonce)) lcmtools_answer(self, nonce, 1);
}

static inline void lcmtools_declare(lcmtools_announcer *self, const char *channel, const char *type, uint64_t fingerprint, int role)
{
    lcmtools_buffer endpoint = {NULL, 0};
    if (self == NULL) return;
    lcmtools_put(&endpoint, 1, 4); /* types */
    lcmtools_put(&endpoint, 1, 4); /* fingerprints */
    lcmtools_put_text(&endpoint, channel);
    lcmtools_put(&endpoint, role, 1);
    lcmtools_put_text(&endpoint, type);
    lcmtools_put(&endpoint, (int64_t) fingerprint, 8);
    lcmtools_put_text(&endpoint, "");                           /* group */
    lcmtools_put(&endpoint, 0, 4);                              /* depth */
    lcmtools_put(&endpoint, 0, 1);                              /* latched */
    for (int i = 0; i < 9; ++i) lcmtools_put(&endpoint, 0, 8); /* counters, which are unknown */
    pthread_mutex_lock(&self->mutex);
    lcmtools_put(&self->endpoints, (int64_t) endpoint.size, 4);
    lcmtools_put_bytes(&self->endpoints, endpoint.data, endpoint.size);
    ++self->number_of_endpoints;
    self->is_listening |= role == 1;
    lcmtools_add_topic(self, channel, role);
    if (*self->folder && !self->is_over) lcmtools_write_record(self);
    pthread_mutex_unlock(&self->mutex);
    free(endpoint.data);
    lcmtools_wake(self, 'w');
}

/* ---- What programs call. Each function may be given NULL for the announcer, and does nothing then. ---- */

static inline void lcmtools_publishes(lcmtools_announcer *self, const char *channel, const char *type, uint64_t fingerprint)
{
    lcmtools_declare(self, channel, type, fingerprint, 0);
}

/* Call it on the thread that calls lcm_handle, or before. */
static inline void lcmtools_subscribes(lcmtools_announcer *self, const char *channel, const char *type, uint64_t fingerprint)
{
    if (self != NULL && self->requests[0] == NULL) {
        self->requests[1] = lcm_subscribe(self->lcm, "/_lcmtools/shutdown", lcmtools_on_shutdown, self);
        self->requests[0] = lcm_subscribe(self->lcm, "/_lcmtools/probe", lcmtools_on_probe, self);
    }
    lcmtools_declare(self, channel, type, fingerprint, 1);
}

/* Write the full form of a legal name; return 0 for another. */
static inline int lcmtools_set_name(char *full, const char *name)
{
    for (const char *at = name; *at; ++at) {
        int is_first = at == name || at[-1] == '/';
        int is_letter = (*at >= 'a' && *at <= 'z') || (*at >= 'A' && *at <= 'Z') || *at == '_';
        int is_slash = *at == '/' && at[1] != '\0' && (at == name || at[-1] != '/');
        if (!is_letter && !is_slash && (is_first || *at < '0' || *at > '9')) return 0;
    }
    int length = snprintf(full, 64, "%s%s", *name == '/' ? "" : "/", name);
    return length > 1 && length < 64 ? length : 0;
}

static inline void lcmtools_describe_process(lcmtools_announcer *self)
{
    uint32_t hash = 2166136261u;
    FILE *file = fopen("/proc/self/cmdline", "r");
    gethostname(self->host, sizeof self->host - 1);
    for (const char *c = self->host; *c; ++c) hash = (hash ^ (uint8_t) *c) * 16777619u;
    self->start_time = lcmtools_now();
    snprintf(self->id, sizeof self->id, "%016" PRIx64 "%08x%08x", (uint64_t) self->start_time, (unsigned) hash, (unsigned) getpid());
    if (file == NULL) return;
    size_t size = fread(self->command, 1, sizeof self->command - 1, file);
    fclose(file);
    while (size > 0 && (self->command[size - 1] == '\0' || (size == 1000 && (self->command[size - 1] & 0x80)))) --size;
    for (size_t i = 0; i < size; ++i)
        if (self->command[i] == '\0') self->command[i] = ' ';
    self->command[size] = '\0';
}

/* Take over the signals that would end the program at once. */
static inline void lcmtools_take_signals(int wakeup)
{
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGPIPE};
    lcmtools_wakeup = wakeup;
    for (int i = 0; i < 4; ++i) {
        struct sigaction before, action;
        memset(&action, 0, sizeof action);
        action.sa_handler = lcmtools_on_signal;
        action.sa_flags = SA_RESTART;
        if (sigaction(numbers[i], NULL, &before) == 0 && before.sa_handler == SIG_DFL) sigaction(numbers[i], &action, NULL);
    }
}

static inline void lcmtools_announcer_destroy(lcmtools_announcer *self)
{
    if (self == NULL) return;
    lcmtools_say_goodbye(self);
    lcmtools_wake(self, 'w');
    pthread_join(self->thread, NULL);
    pthread_mutex_lock(&lcmtools_mutex);
    lcmtools_announcer **place = &lcmtools_announcers;
    while (*place != self) place = &(*place)->next;
    *place = self->next;
    if (lcmtools_wakeup == self->wakeup[1]) lcmtools_wakeup = lcmtools_announcers ? lcmtools_announcers->wakeup[1] : -1;
    pthread_mutex_unlock(&lcmtools_mutex);
    for (int i = 0; i < 2; ++i) {
        if (self->requests[i]) lcm_unsubscribe(self->lcm, self->requests[i]);
        close(self->wakeup[i]);
        free(self->topics[i].data);
    }
    free(self->endpoints.data);
    pthread_mutex_destroy(&self->mutex);
    free(self);
}

/* Announce this program by a name: "lidar_driver", or "/husky0/lidar_driver" in a namespace.
 *
 * lcm  the program's own; the announcer is destroyed before it
 * url  the one given to lcm_create, NULL for that of LCM_DEFAULT_URL
 *
 * Return NULL, after a line on standard error, if the name is not legal: the program goes on unannounced.
 */
static inline lcmtools_announcer *lcmtools_announcer_create(lcm_t *lcm, const char *name, const char *url)
{
    static int is_registered = 0;
    lcmtools_announcer *self = (lcmtools_announcer *) calloc(1, sizeof *self);
    if (self == NULL || lcm == NULL) return free(self), (lcmtools_announcer *) NULL;
    if (!lcmtools_set_name(self->name, name) || pipe(self->wakeup) != 0) {
        fprintf(stderr, "lcmtools: '%s' is not a legal node name; names are at most 62 letters, digits, '_' and '/', and start with a letter\n", name);
        return free(self), (lcmtools_announcer *) NULL;
    }
    self->lcm = lcm;
    lcmtools_describe_process(self);
    if (!lcmtools_make_folder(self->folder, sizeof self->folder, url)) *self->folder = '\0';
    for (int i = 0; i < 2; ++i) {
        fcntl(self->wakeup[i], F_SETFL, O_NONBLOCK);
        fcntl(self->wakeup[i], F_SETFD, FD_CLOEXEC);
    }
    pthread_mutex_init(&self->mutex, NULL);
    sigset_t all, usual; /* the thread leaves signals to the program's own threads */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &usual);
    pthread_create(&self->thread, NULL, lcmtools_run, self);
    pthread_sigmask(SIG_SETMASK, &usual, NULL);
    pthread_mutex_lock(&lcmtools_mutex);
    self->next = lcmtools_announcers;
    lcmtools_announcers = self;
    if (lcmtools_wakeup < 0) lcmtools_take_signals(self->wakeup[1]);
    if (!is_registered) atexit(lcmtools_say_all_goodbyes);
    is_registered = 1;
    pthread_mutex_unlock(&lcmtools_mutex);
    return self;
}

#endif
