/* Tilescope's planes as a class of Godot 4 (GDExtension, from Godot 4.2 on), in plain C.
 *
 *   var plane := TilescopePlane.new()
 *   plane.setup(7, 1.5)                                        # seed, radius
 *   var trees := plane.window(Rect2(0, 0, 180, 180))
 *   trees.append_array(plane.gained(Rect2(0, 0, 180, 180), Rect2(3, 0, 180, 180)))
 *
 * README.md beside this file says how to build it. Godot's numbers in `Rect2` and `PackedVector2Array` are floats (in builds with
 * `precision=single`, the usual ones), so keep within some 100,000 radii of 0.
 */
#include <stdint.h>
#include <stdlib.h>

#include "gdextension_interface.h"
#include "tilescope.h"

/* What Godot keeps in a `StringName`, a `String` and a `PackedVector2Array`: one and two words, whose contents are its own. */
typedef struct { void *word; } Name;
typedef struct { void *words[2]; } Points;
typedef struct { float x, y, width, height; } Rect2;
typedef struct { float x, y; } Vector2;

/* An argument of a method: large enough, and placed in memory as each of these types must be. */
typedef union { Rect2 rect; int64_t whole; double real; } Argument;

/* Libraries for Windows show only the functions that say so. */
#ifdef _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED
#endif

/* The number that identifies the signature of `PackedVector2Array.resize`: Godot's extension_api.json lists it. */
#define RESIZE_HASH 848867239

#define ARGUMENTS_MAX 2

/* Godot's functions, looked up once. */
static struct {
    GDExtensionInterfacePrintErrorWithMessage print_error;
    GDExtensionInterfaceClassdbConstructObject construct_object;
    GDExtensionInterfaceObjectSetInstance set_instance;
    GDExtensionInterfaceClassdbRegisterExtensionClass2 register_class;
    GDExtensionInterfaceClassdbRegisterExtensionClassMethod register_method;
    GDExtensionInterfaceClassdbUnregisterExtensionClass unregister_class;
    GDExtensionInterfaceStringNameNewWithLatin1Chars new_name;
    GDExtensionInterfaceStringNewWithLatin1Chars new_text;
    GDExtensionInterfaceVariantGetPtrConstructor constructor;
    GDExtensionInterfaceVariantGetPtrDestructor destructor;
    GDExtensionInterfaceGetVariantFromTypeConstructor to_variant;
    GDExtensionInterfaceGetVariantToTypeConstructor from_variant;
    GDExtensionInterfacePackedVector2ArrayOperatorIndex point;
    GDExtensionInterfaceVariantGetPtrBuiltinMethod method;
    GDExtensionInterfaceVariantGetType type_of;
    GDExtensionInterfaceVariantCanConvertStrict can_convert;
    GDExtensionPtrBuiltInMethod resize;
} godot;

static GDExtensionClassLibraryPtr library;
static Name class_name, parent_name;

/* An instance of the class: a plane, once `setup` has made it. */
typedef struct { TilescopePlane *plane; } Instance;

/* A function of Godot, before it has its type: compilers warn of casts between functions unless one of the two types is this. */
typedef void (*AnyFunction)(void);

#define LOOK_UP(member, Type, name) godot.member = (GDExtensionInterface##Type)(AnyFunction)look_up(name)

static void complain(const char *function)
{
    godot.print_error("Tilescope", tilescope_message(), function, __FILE__, __LINE__, 0);
}

static TilescopeWindow window_of(const Rect2 *rect)
{
    /* The sums in doubles, as a float's would move the edges of windows that should touch. */
    TilescopeWindow window;
    window.left = rect->x;
    window.bottom = rect->y;
    window.right = (double)rect->x + rect->width;
    window.top = (double)rect->y + rect->height;
    return window;
}

/* Writes samples into an array of Godot's, which is resized to their number. */
static void store(Points *array, const TilescopePoint *points, size_t count)
{
    const int64_t size = (int64_t)count;
    const GDExtensionConstTypePtr arguments[] = {(GDExtensionConstTypePtr)&size};
    int64_t status = 0;
    godot.resize((GDExtensionTypePtr)array, arguments, (GDExtensionTypePtr)&status, 1);

    for (int64_t i = 0; i < size; i++) {
        Vector2 *at = (Vector2 *)godot.point((GDExtensionTypePtr)array, i);
        at->x = (float)points[i].x;
        at->y = (float)points[i].y;
    }
}

/* The methods. Arguments and result have Godot's types; the result is made before, as an empty array or as 0. */

static void setup(void *unused, GDExtensionClassInstancePtr self, const GDExtensionConstTypePtr *arguments,
                  GDExtensionTypePtr result)
{
    Instance *instance = (Instance *)self;
    TilescopeSettings settings = tilescope_settings();
    (void)unused;
    settings.seed = (uint64_t)*(const int64_t *)arguments[0];
    settings.radius = *(const double *)arguments[1];

    TilescopePlane *plane;
    const bool is_made = tilescope_plane_new(&settings, &plane) == TILESCOPE_OK;
    if (is_made) {
        tilescope_plane_free(instance->plane);
        instance->plane = plane;
    } else {
        /* The plane of before stays. */
        complain("setup");
    }
    *(GDExtensionBool *)result = is_made;
}

/* Stores the samples of `to`, or of `to` without `from` if that is given, for a method of this name. After a failure the array
 * stays empty. */
static void collect(const char *name, const Instance *instance, const Rect2 *from, const Rect2 *to, Points *result)
{
    const TilescopeWindow window = window_of(to);
    size_t capacity, count;
    if (tilescope_plane_capacity(instance->plane, &window, &capacity) != TILESCOPE_OK) {
        complain(name);
        return;
    }
    TilescopePoint *points = malloc(capacity * sizeof *points);
    if (!points) {
        godot.print_error("Tilescope", "There is no memory for the samples", name, __FILE__, __LINE__, 0);
        return;
    }

    TilescopeStatus status;
    if (from) {
        const TilescopeWindow before = window_of(from);
        status = tilescope_plane_gained(instance->plane, &before, &window, points, capacity, &count);
    } else {
        status = tilescope_plane_window(instance->plane, &window, points, capacity, &count);
    }

    if (status == TILESCOPE_OK) {
        store(result, points, count);
    } else {
        complain(name);
    }
    free(points);
}

static void window(void *unused, GDExtensionClassInstancePtr self, const GDExtensionConstTypePtr *arguments,
                   GDExtensionTypePtr result)
{
    (void)unused;
    collect("window", (const Instance *)self, NULL, (const Rect2 *)arguments[0], (Points *)result);
}

static void gained(void *unused, GDExtensionClassInstancePtr self, const GDExtensionConstTypePtr *arguments,
                   GDExtensionTypePtr result)
{
    (void)unused;
    collect("gained", (const Instance *)self, (const Rect2 *)arguments[0], (const Rect2 *)arguments[1], (Points *)result);
}

/* A method with the types of its result and arguments. */
typedef struct {
    const char *name;
    GDExtensionClassMethodPtrCall call;
    GDExtensionVariantType result;
    uint32_t count;
    GDExtensionVariantType types[ARGUMENTS_MAX];
    const char *arguments[ARGUMENTS_MAX];
} Method;

static Method methods[] = {
    {"setup", setup, GDEXTENSION_VARIANT_TYPE_BOOL, 2, {GDEXTENSION_VARIANT_TYPE_INT, GDEXTENSION_VARIANT_TYPE_FLOAT},
     {"seed", "radius"}},
    {"window", window, GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR2_ARRAY, 1, {GDEXTENSION_VARIANT_TYPE_RECT2}, {"view"}},
    {"gained", gained, GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR2_ARRAY, 2,
     {GDEXTENSION_VARIANT_TYPE_RECT2, GDEXTENSION_VARIANT_TYPE_RECT2}, {"from", "to"}},
};

/* A call by a script without types: arguments and result are variants. */
static void call(void *method_of_call, GDExtensionClassInstancePtr self, const GDExtensionConstVariantPtr *arguments,
                 GDExtensionInt count, GDExtensionVariantPtr result, GDExtensionCallError *error)
{
    const Method *method = (const Method *)method_of_call;
    if (count != method->count) {
        const bool too_few = count < method->count;
        error->error = too_few ? GDEXTENSION_CALL_ERROR_TOO_FEW_ARGUMENTS : GDEXTENSION_CALL_ERROR_TOO_MANY_ARGUMENTS;
        error->argument = error->expected = (int32_t)method->count;
        return;
    }
    error->error = GDEXTENSION_CALL_OK;

    Argument values[ARGUMENTS_MAX];
    GDExtensionConstTypePtr pointers[ARGUMENTS_MAX];
    for (uint32_t i = 0; i < method->count; i++) {
        /* An int may stand for a float, and a `Rect2i` for a `Rect2`. */
        if (!godot.can_convert(godot.type_of(arguments[i]), method->types[i])) {
            error->error = GDEXTENSION_CALL_ERROR_INVALID_ARGUMENT;
            error->argument = (int32_t)i;
            error->expected = (int32_t)method->types[i];
            return;
        }
        godot.from_variant(method->types[i])((GDExtensionUninitializedTypePtr)&values[i], (GDExtensionVariantPtr)arguments[i]);
        pointers[i] = (GDExtensionConstTypePtr)&values[i];
    }

    /* The array is copied into the variant, so that this one must be given back. A bool needs neither. */
    Points made = {{NULL, NULL}};
    const bool is_array = method->result == GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR2_ARRAY;
    if (is_array) {
        godot.constructor(method->result, 0)((GDExtensionUninitializedTypePtr)&made, NULL);
    }
    method->call(method_of_call, self, pointers, (GDExtensionTypePtr)&made);
    godot.to_variant(method->result)((GDExtensionUninitializedVariantPtr)result, (GDExtensionTypePtr)&made);
    if (is_array) {
        godot.destructor(method->result)((GDExtensionTypePtr)&made);
    }
}

static GDExtensionObjectPtr create(void *unused)
{
    (void)unused;
    /* Before the object, so that no object is left without an instance if there is no memory. */
    Instance *instance = calloc(1, sizeof *instance);
    if (!instance) {
        return NULL;
    }
    GDExtensionObjectPtr object = godot.construct_object((GDExtensionConstStringNamePtr)&parent_name);
    godot.set_instance(object, (GDExtensionConstStringNamePtr)&class_name, (GDExtensionClassInstancePtr)instance);
    return object;
}

static void destroy(void *unused, GDExtensionClassInstancePtr self)
{
    (void)unused;
    tilescope_plane_free(((Instance *)self)->plane);
    free(self);
}

static GDExtensionPropertyInfo property(GDExtensionVariantType type, Name *name, Name *no_class, Name *no_hint)
{
    GDExtensionPropertyInfo info = {0};
    info.type = type;
    info.name = (GDExtensionStringNamePtr)name;
    info.class_name = (GDExtensionStringNamePtr)no_class;
    info.hint_string = (GDExtensionStringPtr)no_hint;
    return info;
}

/* Adds a method to the class. Its names are made of static text, so that Godot keeps them and none must be given back. */
static void add(Method *method)
{
    Name name, no_class, no_hint, names[ARGUMENTS_MAX];
    godot.new_name((GDExtensionUninitializedStringNamePtr)&name, method->name, 1);
    godot.new_name((GDExtensionUninitializedStringNamePtr)&no_class, "", 1);
    godot.new_text((GDExtensionUninitializedStringPtr)&no_hint, "");

    GDExtensionPropertyInfo result = property(method->result, &no_class, &no_class, &no_hint);
    GDExtensionPropertyInfo arguments[ARGUMENTS_MAX];
    GDExtensionClassMethodArgumentMetadata kinds[ARGUMENTS_MAX] = {GDEXTENSION_METHOD_ARGUMENT_METADATA_NONE};
    for (uint32_t i = 0; i < method->count; i++) {
        godot.new_name((GDExtensionUninitializedStringNamePtr)&names[i], method->arguments[i], 1);
        arguments[i] = property(method->types[i], &names[i], &no_class, &no_hint);
    }

    GDExtensionClassMethodInfo info = {0};
    info.name = (GDExtensionStringNamePtr)&name;
    info.method_userdata = method;
    info.call_func = call;
    info.ptrcall_func = method->call;
    info.method_flags = GDEXTENSION_METHOD_FLAGS_DEFAULT;
    info.has_return_value = 1;
    info.return_value_info = &result;
    info.argument_count = method->count;
    info.arguments_info = arguments;
    info.arguments_metadata = kinds;
    godot.register_method(library, (GDExtensionConstStringNamePtr)&class_name, &info);
}

static void initialize(void *unused, GDExtensionInitializationLevel level)
{
    (void)unused;
    if (level != GDEXTENSION_INITIALIZATION_SCENE) {
        return;
    }
    godot.new_name((GDExtensionUninitializedStringNamePtr)&class_name, "TilescopePlane", 1);
    godot.new_name((GDExtensionUninitializedStringNamePtr)&parent_name, "RefCounted", 1);

    GDExtensionClassCreationInfo2 info = {0};
    info.is_exposed = 1;
    info.create_instance_func = create;
    info.free_instance_func = destroy;
    godot.register_class(library, (GDExtensionConstStringNamePtr)&class_name, (GDExtensionConstStringNamePtr)&parent_name, &info);
    for (size_t i = 0; i < sizeof methods / sizeof methods[0]; i++) {
        add(&methods[i]);
    }
}

static void deinitialize(void *unused, GDExtensionInitializationLevel level)
{
    (void)unused;
    if (level == GDEXTENSION_INITIALIZATION_SCENE) {
        godot.unregister_class(library, (GDExtensionConstStringNamePtr)&class_name);
    }
}

/* The entry that tilescope.gdextension names. */
EXPORTED GDExtensionBool tilescope_godot(GDExtensionInterfaceGetProcAddress look_up, GDExtensionClassLibraryPtr own_library,
                                         GDExtensionInitialization *initialization)
{
    library = own_library;
    LOOK_UP(print_error, PrintErrorWithMessage, "print_error_with_message");
    LOOK_UP(construct_object, ClassdbConstructObject, "classdb_construct_object");
    LOOK_UP(set_instance, ObjectSetInstance, "object_set_instance");
    LOOK_UP(register_class, ClassdbRegisterExtensionClass2, "classdb_register_extension_class2");
    LOOK_UP(register_method, ClassdbRegisterExtensionClassMethod, "classdb_register_extension_class_method");
    LOOK_UP(unregister_class, ClassdbUnregisterExtensionClass, "classdb_unregister_extension_class");
    LOOK_UP(new_name, StringNameNewWithLatin1Chars, "string_name_new_with_latin1_chars");
    LOOK_UP(new_text, StringNewWithLatin1Chars, "string_new_with_latin1_chars");
    LOOK_UP(constructor, VariantGetPtrConstructor, "variant_get_ptr_constructor");
    LOOK_UP(destructor, VariantGetPtrDestructor, "variant_get_ptr_destructor");
    LOOK_UP(to_variant, GetVariantFromTypeConstructor, "get_variant_from_type_constructor");
    LOOK_UP(from_variant, GetVariantToTypeConstructor, "get_variant_to_type_constructor");
    LOOK_UP(type_of, VariantGetType, "variant_get_type");
    LOOK_UP(can_convert, VariantCanConvertStrict, "variant_can_convert_strict");
    LOOK_UP(point, PackedVector2ArrayOperatorIndex, "packed_vector2_array_operator_index");
    LOOK_UP(method, VariantGetPtrBuiltinMethod, "variant_get_ptr_builtin_method");

    Name resize;
    godot.new_name((GDExtensionUninitializedStringNamePtr)&resize, "resize", 1);
    godot.resize = godot.method(GDEXTENSION_VARIANT_TYPE_PACKED_VECTOR2_ARRAY, (GDExtensionConstStringNamePtr)&resize, RESIZE_HASH);

    initialization->minimum_initialization_level = GDEXTENSION_INITIALIZATION_SCENE;
    initialization->initialize = initialize;
    initialization->deinitialize = deinitialize;
    return 1;
}
